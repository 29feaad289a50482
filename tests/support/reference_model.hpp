/// Slow reference geometry of models: in double precision, written from the definitions, without
/// code of the kernels.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <optional>

#include "storage/data/cloud.hpp"

namespace trivet::reference {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

inline double diameter(PointsView points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      largest = std::max(largest, (points[i].cast<double>() - points[j].cast<double>()).norm());
    }
  }
  return largest;
}

inline Eigen::Vector3d corner(PointsView vertices, const Column<std::uint32_t>& which,
                              std::size_t t) {
  return vertices[which[t]].cast<double>();
}

/// The distance along a ray to a triangle that is enlarged by a fraction of itself at each side;
/// infinity without a hit.
inline double ray_triangle(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                           const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                           const Eigen::Vector3d& c, double growth) {
  Eigen::Matrix3d system;  // origin + t direction = a + u (b - a) + v (c - a)
  system << b - a, c - a, -direction;
  if (std::abs(system.determinant()) < 1e-12) return kInfinity;
  const Eigen::Vector3d uvt = system.inverse() * (origin - a);
  const bool inside = uvt.x() >= -growth && uvt.y() >= -growth && uvt.x() + uvt.y() <= 1 + growth;
  return inside && uvt.z() >= 0 ? uvt.z() : kInfinity;
}

/// The distance along a ray to the nearest triangle, or infinity. None if the answer depends on
/// rounding, since the ray passes within a fraction of 1e-4 of an edge.
inline std::optional<double> nearest_hit(PointsView vertices, const Triangles& triangles,
                                         const Eigen::Vector3f& origin,
                                         const Eigen::Vector3f& direction) {
  double shrunk = kInfinity, grown = kInfinity;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto meet = [&](double growth) {
      return ray_triangle(origin.cast<double>(), direction.cast<double>(),
                          corner(vertices, triangles.a, t), corner(vertices, triangles.b, t),
                          corner(vertices, triangles.c, t), growth);
    };
    shrunk = std::min(shrunk, meet(-1e-4));
    grown = std::min(grown, meet(1e-4));
  }
  if (shrunk != grown) return std::nullopt;
  return shrunk;
}

/// The distance along a ray to the first hit with a sphere; infinity without a hit.
inline double ray_sphere(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
                         const Eigen::Vector3f& center, double radius) {
  const Eigen::Vector3d o = (origin - center).cast<double>(), d = direction.cast<double>();
  const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - radius * radius;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return kInfinity;
  const double enter = (-b - std::sqrt(discriminant)) / a;
  const double leave = (-b + std::sqrt(discriminant)) / a;
  return enter >= 0 ? enter : leave >= 0 ? leave : kInfinity;
}

}  // namespace trivet::reference
