/// Uniformly distributed keypoints.
#pragma once

#include <cstdint>

#include "kernels/common/voxels.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Working memory of find_uniform_keypoints.
struct UniformScratch {
  Voxels voxels;
  VoxelScratch grouping;
};

/// Choose from each voxel the point nearest to the mean of its points; ties keep the first.
///
/// points   n positions; those with a non-finite coordinate are omitted
/// cell     edge of a voxel, > 0
/// indices  indices of the keypoints, by voxel, ascending in (z, y, x)
/// Source: uniform seeds, Guo et al., IJCV 2013, section 4.
void find_uniform_keypoints(PointsView points, float cell, Column<std::uint32_t>& indices,
                            UniformScratch& scratch);

}  // namespace trivet::kernels
