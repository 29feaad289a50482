/// Keypoints of a surface with their local reference frames and Tri-Spin-Images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/spin_images/tri_spin_image.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

struct Descriptions {
  Points keypoints;
  std::vector<Eigen::Matrix3f> frames;  ///< rows e1, e2, e3
  Column<float> images;                 ///< kernels::kTriSpinSize numbers per keypoint

  std::size_t size() const noexcept { return frames.size(); }
  void clear() noexcept {
    keypoints.resize(0);
    frames.clear();
    images.clear();
  }
  std::span<const float> image(std::size_t i) const noexcept {
    return std::span(images).subspan(i * kernels::kTriSpinSize, kernels::kTriSpinSize);
  }
};

// Shares of a support's radius, the same for scenes and models:
inline constexpr float kCell = 0.5F;  ///< edge of the voxels for gathering supports
/// Radius of the balls in which points share areas: 2.5 resolutions.
inline constexpr float kShare = 0.15F;

/// Describe the keypoints whose frame is sufficiently certain, and append them in their order.
///
/// points     n, sampled evenly
/// normals    n, outward or toward the sensor
/// keypoints  indices < n
/// radius     radius of the supports, > 0
/// Returns the described ones of `keypoints`, rising. Same bytes for any number of threads.
std::vector<std::uint32_t> describe_surface(PointsView points, NormalsView normals,
                                            std::span<const std::uint32_t> keypoints, float radius,
                                            const kernels::FrameLimits& limits, Descriptions& out);

}  // namespace trivet::engine
