/// Histograms of the surface around an axis.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>

#include "kernels/spin_images/support.hpp"

namespace trivet::kernels {

inline constexpr std::size_t kSpinBins = 15;  ///< bins along either side of an image
inline constexpr std::size_t kSpinImageSize = kSpinBins * kSpinBins;

/// Working memory of spin_image.
struct SpinScratch {
  Column<float> weights;  // four per point: for its bin, the next along, and both one row on
  Column<std::int32_t> bins;
};

/// Spread the area of each point of a support over the four bins around it. Row i stands for the
/// height beta = radius (1 - 2 i / 14) along the axis, column j for the distance alpha = radius j /
/// 14 from it.
///
/// axis    unit vector through the keypoint
/// radius  > 0, radius of the support
/// image   kSpinImageSize numbers, row by row; their sum is the support's area
/// No lock or throw; the scratch grows once. Same bits on any processor.
/// Source: Johnson and Hebert, PAMI 1999; bins of Guo et al., GRAPP 2013, 2 radius / 14 by radius /
/// 14.
void spin_image(const Support& support, const Eigen::Vector3f& axis, float radius,
                std::span<float, kSpinImageSize> image, SpinScratch& scratch);

/// Scale images to a sum of 1 and take square roots. Euclidean distances between such images are
/// Hellinger distances, and the sampling density cancels. An image without area stays 0.
/// Source: Arandjelovic and Zisserman, CVPR 2012 (square roots of histograms).
void normalize_spin_image(std::span<float, kSpinImageSize> image) noexcept;

}  // namespace trivet::kernels
