#include "kernels/surfaces/subsample_grid_minimum.hpp"

#include <algorithm>

namespace trivet::kernels {

void subsample_grid_minimum(PointsView points, float cell, Column<std::uint32_t>& indices,
                            SubsampleScratch& scratch) {
  const PointsView flat = flatten(points, scratch);
  Voxels& squares = scratch.voxels;
  group_by_voxel(flat, fit_lattice(flat, cell), squares, scratch.grouping);
  indices.resize(squares.size());
  for (std::size_t s = 0; s < squares.size(); ++s) {
    indices[s] = *std::ranges::min_element(squares.points_of(s), {},
                                           [&](std::uint32_t i) { return points.z[i]; });
  }
}

}  // namespace trivet::kernels
