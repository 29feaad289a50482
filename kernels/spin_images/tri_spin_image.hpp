/// The Tri-Spin-Image descriptor: a keypoint's surface in its local reference frame.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "kernels/spin_images/local_frame.hpp"
#include "kernels/spin_images/spin_image.hpp"
#include "kernels/spin_images/support.hpp"

namespace trivet::kernels {

inline constexpr std::size_t kTriSpinSize = 3 * kSpinImageSize;

/// Weight of the images about e1 and e2, which change when noise rotates the frame about the
/// normal. On noisy and thinned scans of eight models, 0.7 finds positions as well as 1 or better,
/// up to 1.7 % of them.
inline constexpr float kTurningWeight = 0.7F;

/// Limits below which a frame is too uncertain to match by: it would turn with the noise.
struct FrameLimits {
  std::size_t min_points = 40;     ///< points in the support
  float min_hold = 0.03F;          ///< reliability of e1 from heights
  float min_second_ratio = 1.03F;  ///< ratio of the second eigenvalue to the smallest
  float max_lean = 1;  ///< offset of the surface to one side [radii]; 0.15 excludes borders
  bool operator==(const FrameLimits&) const = default;
};

/// Working memory of describe_keypoint.
struct TriSpinScratch {
  Support support;
  SpinScratch spin;
};

/// Compute the spin images about e1, e2 and e3 of the frame of a support, each normalized, the
/// first two multiplied by kTurningWeight.
///
/// normal   normal of the keypoint, outward or towards the sensor
/// radius   radius of the support, > 0
/// image    kTriSpinSize numbers; not written if the frame is too uncertain
/// Returns the frame; its axes are 0 if it is too uncertain, or the normal is NaN.
/// Same bits on any processor. The scratch grows once.
/// Source: Guo et al., "Trisi: a distinctive local surface descriptor for 3D modeling and object
/// recognition", GRAPP 2013; e1 by aim_first_axis.
LocalFrame describe_support(const Support& support, const Eigen::Vector3f& normal, float radius,
                            const FrameLimits& limits, std::span<float, kTriSpinSize> image,
                            SpinScratch& scratch);

/// Points of a surface with their areas.
struct WeightedSurface {
  const VoxelHash& grid;         ///< grid of the points
  std::span<const float> areas;  ///< area that each point represents; empty: equal areas
};

/// A position on a surface and its normal, outward or towards the sensor.
struct Keypoint {
  Eigen::Vector3f position, normal;
};

/// As describe_support, for the points of a surface around a keypoint.
LocalFrame describe_keypoint(const WeightedSurface& surface, const Keypoint& keypoint, float radius,
                             const FrameLimits& limits, std::span<float, kTriSpinSize> image,
                             TriSpinScratch& scratch);

}  // namespace trivet::kernels
