#include "kernels/surfaces/solid_angles.hpp"

#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {

SolidAngles sum_solid_angles(PointsView vertices, const Triangles& triangles,
                             const Eigen::Vector3d& eye, std::size_t first, std::size_t count) {
  TRIVET_REQUIRE(first + count <= triangles.size(), "triangles beyond the last");
  const auto corner = [&](std::uint32_t vertex) -> Eigen::Vector3d {
    return vertices[vertex].cast<double>() - eye;
  };
  SolidAngles sums;
  for (std::size_t t = first; t < first + count; ++t) {
    const Eigen::Vector3d a = corner(triangles.a[t]), b = corner(triangles.b[t]),
                          c = corner(triangles.c[t]);
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    const double volume = a.dot(b.cross(c));
    const double angle = 2 * std::atan2(std::abs(volume), la * lb * lc + a.dot(b) * lc +
                                                              a.dot(c) * lb + b.dot(c) * la);
    // The normal (b - a) x (c - a) points away from the eye where the volume is positive.
    (volume < 0 ? sums.front : sums.back) += volume != 0 ? angle : 0;
  }
  return sums;
}

}  // namespace trivet::kernels
