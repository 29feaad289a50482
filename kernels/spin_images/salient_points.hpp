/// Salient keypoints.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Rate points by intrinsic shape signatures: the smallest eigenvalue of the scatter of their
/// neighborhood, if its three eigenvalues differ.
///
/// grid      grid of the points
/// points    n finite positions
/// radius    radius of a neighborhood, > 0
/// saliency  n: the smallest eigenvalue of the scatter about the point; 0 if the second largest is
///           not below 0.975 of the largest, or the smallest of the second, or there are fewer than
///           5 neighbors
/// A neighbor's weight is one over the number of points around it.
/// Rows are independent given the weights. Allocates once, for these.
/// Source: Zhong, ICCV Workshops 2009, eq. 1 to 4.
void rate_by_iss(const VoxelHash& grid, PointsView points, float radius, std::span<float> saliency);

/// Rate points by the Harris operator on their surface: its change in both directions.
///
/// normals   n unit vectors; where one is NaN the rating is 0
/// saliency  n: det E - 0.04 trace(E)^2 of the derivatives of a quadratic patch, with lengths in
///           radii; may be negative; 0 for fewer than 6 neighbors
/// Source: Sipiran and Bustos, The Visual Computer 2011, section 3.
void rate_by_harris(const VoxelHash& grid, PointsView points, NormalsView normals, float radius,
                    std::span<float> saliency);

/// Non-maximum suppression: choose the points with a saliency above 0 that no point within the
/// radius exceeds; ties keep the first.
///
/// indices  ascending
void find_salient_points(const VoxelHash& grid, PointsView points, std::span<const float> saliency,
                         float radius, Column<std::uint32_t>& indices);

}  // namespace trivet::kernels
