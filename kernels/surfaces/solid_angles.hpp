/// Which sides of its triangles a surface turns towards a place.
#pragma once

#include <cstddef>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Solid angles that triangles take up as seen from a place, each for itself, whatever hides it
/// [sr]. Of a surface seen from there one is 0; of a closed one around which nothing is both are
/// equal; from within a closed one they differ by 4 pi.
struct SolidAngles {
  double front = 0;  ///< of those that are counter-clockwise as seen from there
  double back = 0;   ///< of the others
};

/// Add up the solid angles of the triangles first .. first + count.
///
/// vertices  n positions, in the unit and frame of `eye`; every index of the triangles is < n
/// A triangle that the eye lies in counts for nothing. No allocation.
/// Source: van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed.
/// Eng. 30, 1983, eq. 8.
SolidAngles sum_solid_angles(PointsView vertices, const Triangles& triangles,
                             const Eigen::Vector3d& eye, std::size_t first, std::size_t count);

}  // namespace trivet::kernels
