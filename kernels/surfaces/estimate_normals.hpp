/// Normals of points with given neighborhoods.
#pragma once

#include <Eigen/Core>
#include <span>

#include "storage/data/neighborhoods.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Fit a plane to each neighborhood and write its unit normal and the residual.
///
/// points     n finite positions
/// neighbors  m rows of indices < n; a row includes the point itself if it is to count
/// normals    m unit vectors of arbitrary sign (see orient_normals); NaN for a row of fewer than 3
///            points, or of collinear points
/// residuals  m RMS distances to the plane, unit of the points, NaN where the normal is; or empty
/// Pre: normals.size() == neighbors.size(). Outputs must not alias points.
/// No allocation or lock. Rows are independent: any split into chunks gives the same bits.
/// Source: Hoppe et al., SIGGRAPH 1992, tangent plane estimation; about the mean, not the query.
void estimate_normals(PointsView points, NeighborhoodsView neighbors, NormalsSpan normals,
                      std::span<float> residuals = {});

/// Orient normals towards the sensor.
///
/// points     n positions
/// viewpoint  position of the sensor, same frame and unit
/// normals    n unit vectors, flipped in place if normal . (viewpoint - point) < 0
void orient_normals(PointsView points, const Eigen::Vector3f& viewpoint, NormalsSpan normals);

}  // namespace trivet::kernels
