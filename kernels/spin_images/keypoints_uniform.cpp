#include "kernels/spin_images/keypoints_uniform.hpp"

#include <limits>

namespace trivet::kernels {

void find_uniform_keypoints(PointsView points, float cell, Column<std::uint32_t>& indices,
                            UniformScratch& scratch) {
  group_by_voxel(points, fit_lattice(points, static_cast<double>(cell)), scratch.voxels,
                 scratch.grouping);
  indices.resize(scratch.voxels.size());
  for (std::size_t v = 0; v < scratch.voxels.size(); ++v) {
    const auto members = scratch.voxels.points_of(v);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : members) mean += points[i].cast<double>();
    mean /= static_cast<double>(members.size());
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : members) {
      const double squared = (points[i].cast<double>() - mean).squaredNorm();
      if (squared >= nearest) continue;
      nearest = squared;
      indices[v] = i;
    }
  }
}

}  // namespace trivet::kernels
