/// Subsampling by voxels without averaging across edges.
#pragma once

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Replace the points of each voxel by one oriented point for each direction of its surface.
///
/// cloud          n positions and unit vectors; points with a non-finite coordinate or a NaN normal
///                are omitted
/// cell           edge of a voxel, > 0, unit of the points; voxels have a corner at the origin
/// max_angle_rad  largest angle between a point's normal and that of its group's first point; about
///                0.52 (30 degrees) in the source; from pi on, a voxel is one group
/// out_points     mean position of each group; by voxel, ascending in (z, y, x), then by first
///                point
/// out_normals    mean direction of each group, unit length; that of the first point if the mean is
///                0
///
/// Within a voxel each point, by ascending index, joins the first group whose first normal is near
/// enough, or starts a new one. So an edge gives two points and a corner three. A permutation of
/// the points may group those at the limit of the angle differently. Cost: O(n) times groups per
/// voxel.
/// Source: Vidal, Lin, Llado, Marti, Sensors 18(8), 2018, section on preprocessing.
void subsample_by_normals(const OrientedView& cloud, float cell, float max_angle_rad,
                          Points& out_points, Normals& out_normals, SubsampleScratch& scratch);

}  // namespace trivet::kernels
