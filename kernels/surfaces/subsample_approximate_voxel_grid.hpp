/// Subsample by voxels in one pass, without sorting.
#pragma once

#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Replace runs of points that share a voxel by their centroids.
///
/// points  n positions; those with a non-finite coordinate are omitted
/// cell    edge of a voxel, > 0, unit of the points; voxels have a corner at the origin
/// out     centroids in the order in which their sums left the table
///
/// A table of 512 slots holds running sums. A point that finds its slot occupied by another voxel
/// outputs that voxel's centroid and claims the slot; the rest is output at the end. So a voxel may
/// be output more than once, and a permutation of the points gives other centroids. Cost: O(n).
/// Allocates only what `out` grows by. Source: the approximate voxel grid of PCL; the thesis
/// (section 3.1.2) assumes that its points are centers of voxels, but they are centroids.
void subsample_approximate_voxel_grid(PointsView points, float cell, Points& out);

}  // namespace trivet::kernels
