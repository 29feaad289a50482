/// Subsampling by voxels: one centroid for each.
#pragma once

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Replace the points of each voxel by their centroid.
///
/// points  n positions; those with a non-finite coordinate are omitted
/// cell    edge of a voxel, > 0, unit of the points; voxels have a corner at the origin
/// out     one point per occupied voxel, ascending by (z, y, x) of the voxel
/// A permutation of the points gives the same voxels in the same order; their centroids, summed in
/// double in the order of the points, may differ in the last bit. Cost: O(n).
/// Averages across edges and thin walls: see subsample_by_normals.
/// Source: the voxel grid filter of PCL, as described in the thesis (section 3.1.1).
void subsample_voxel_grid(PointsView points, float cell, Points& out, SubsampleScratch& scratch);

}  // namespace trivet::kernels
