/// Working memory of the subsamplers, reused to avoid allocation.
#pragma once

#include <Eigen/Core>

#include "kernels/common/voxels.hpp"
#include "storage/common/columns.hpp"

namespace trivet::kernels {

/// Points of one voxel whose normals agree with that of the first point.
struct OrientedGroup {
  Eigen::Matrix<float, 3, 1, Eigen::DontAlign> seed;  ///< normal of the first point
  std::uint32_t num_points = 0;
  Eigen::Matrix<double, 3, 1, Eigen::DontAlign> position_sum{0, 0, 0}, normal_sum{0, 0, 0};
};

struct SubsampleScratch {
  Voxels voxels;
  VoxelScratch grouping;
  Column<float> flat_z;          ///< 0 for each point, NaN if its z is not finite
  Column<OrientedGroup> groups;  ///< groups of one voxel
};

/// The points projected to z = 0; z stays NaN where it is not finite.
inline PointsView flatten(PointsView points, SubsampleScratch& scratch) {
  scratch.flat_z.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) scratch.flat_z[i] = points.z[i] - points.z[i];
  return {points.x, points.y, scratch.flat_z};
}

}  // namespace trivet::kernels
