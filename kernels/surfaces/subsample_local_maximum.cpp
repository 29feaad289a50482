#include "kernels/surfaces/subsample_local_maximum.hpp"

#include <cmath>

#include "kernels/common/voxel_hash.hpp"

namespace trivet::kernels {

void subsample_local_maximum(PointsView points, float radius, Column<std::uint32_t>& indices,
                             SubsampleScratch& scratch) {
  const PointsView flat = flatten(points, scratch);
  const VoxelHash grid(flat, radius);
  indices.clear();
  indices.reserve(grid.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!flat[i].allFinite()) continue;
    std::uint32_t num_neighbors = 0;
    bool highest = true;
    grid.visit_within(flat[i], radius, [&](std::uint32_t j, float) {
      if (j == i) return;
      ++num_neighbors;
      if (points.z[j] > points.z[i] || (points.z[j] == points.z[i] && j < i)) highest = false;
    });
    if (!highest || num_neighbors == 0) indices.push_back(i);
  }
}

}  // namespace trivet::kernels
