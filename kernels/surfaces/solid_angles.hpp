/// Front-facing and back-facing parts of a surface seen from a point.
#pragma once

#include <cstddef>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Solid angles of triangles seen from a point, each summed without occlusion [sr]. For a one-sided
/// surface, one sum is 0. From outside a closed surface both sums are equal; from inside they
/// differ by 4 pi.
struct SolidAngles {
  double front = 0;  ///< sum for triangles that are counter-clockwise from there
  double back = 0;   ///< sum for the others
};

/// Sum the solid angles of the triangles first .. first + count.
///
/// vertices  n positions, in the unit and frame of `eye`; every index of the triangles is < n
/// A triangle that contains the eye is ignored. No allocation.
/// Source: van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed.
/// Eng. 30, 1983, eq. 8.
SolidAngles sum_solid_angles(PointsView vertices, const Triangles& triangles,
                             const Eigen::Vector3d& eye, std::size_t first, std::size_t count);

}  // namespace trivet::kernels
