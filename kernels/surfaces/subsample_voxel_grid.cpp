#include "kernels/surfaces/subsample_voxel_grid.hpp"

namespace trivet::kernels {

void subsample_voxel_grid(PointsView points, float cell, Points& out, SubsampleScratch& scratch) {
  Voxels& voxels = scratch.voxels;
  group_by_voxel(points, fit_lattice(points, cell), voxels, scratch.grouping);
  out.resize(voxels.size());
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::uint32_t i : voxels.points_of(v)) sum += points[i].cast<double>();
    sum /= static_cast<double>(voxels.points_of(v).size());
    out.set(v, sum.cast<float>());
  }
}

}  // namespace trivet::kernels
