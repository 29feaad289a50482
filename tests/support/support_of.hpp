/// The points in the neighborhood of a keypoint, gathered for one test.
#pragma once

#include <span>

#include "kernels/spin_images/support.hpp"

namespace trivet::test {

inline kernels::Support support_of(PointsView points, float radius,
                                   const Eigen::Vector3f& keypoint = {0, 0, 0},
                                   std::span<const float> areas = {}) {
  kernels::Support support;
  kernels::gather_support(kernels::VoxelHash(points, 0.5F * radius), areas, keypoint, radius,
                          support);
  return support;
}

}  // namespace trivet::test
