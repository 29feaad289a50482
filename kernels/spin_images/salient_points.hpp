/// Keypoints where the surface is salient.
#pragma once

#include <cstdint>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Rate points by intrinsic shape signatures: the smallest spread of their neighborhood, where its
/// three spreads differ.
///
/// grid      of the points
/// points    n finite positions
/// radius    of a neighborhood, > 0
/// saliency  n: the smallest eigenvalue of the scatter about the point; 0 where the second largest
///           is not below 0.975 of the largest, or the smallest of the second, or there are fewer
///           than 5 neighbors
/// A neighbor's weight is one over the number of points around it.
/// Rows are independent given the weights. Takes memory once, for these.
/// Source: Zhong, ICCV Workshops 2009, eq. 1 to 4.
void rate_by_iss(const VoxelHash& grid, PointsView points, float radius, std::span<float> saliency);

/// Rate points by the Harris operator on their surface: how it changes in both directions.
///
/// normals   n unit vectors; where one is NaN the rate is 0
/// saliency  n: det E - 0.04 trace(E)^2 of the derivatives of a quadratic patch, with lengths in
///           radii; may be negative; 0 for fewer than 6 neighbors
/// Source: Sipiran and Bustos, The Visual Computer 2011, section 3.
void rate_by_harris(const VoxelHash& grid, PointsView points, NormalsView normals, float radius,
                    std::span<float> saliency);

/// Choose the points with a rate above 0 that no point within the radius exceeds; of equal ones the
/// first.
///
/// indices  rising
void find_salient_points(const VoxelHash& grid, PointsView points, std::span<const float> saliency,
                         float radius, Column<std::uint32_t>& indices);

}  // namespace trivet::kernels
