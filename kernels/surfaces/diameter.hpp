/// Diameter of a model.
#pragma once

#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Find the largest distance between two points.
///
/// points  n finite positions [m]
/// Returns the distance [m], exact to one part in 10^6; 0 for fewer than two points.
/// Cost: n log n for usual shapes, for a sphere too; 10^6 points take well under a second.
/// Allocates once, for a copy of the points that may be an end of the diameter.
/// Method: two-tree branch and bound. A pair of cells is dropped if its bound does not exceed the
/// best distance found. The bound uses the cells' radii and cones of directions about a common
/// center, which keeps it tight for spheres, unlike a bound from boxes.
float find_diameter(PointsView points);

}  // namespace trivet::kernels
