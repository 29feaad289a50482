/// Distances between meshes, by slow reference code in double precision.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::reference {

using Facet = std::array<Eigen::Vector3d, 3>;

inline std::vector<Facet> facets_of(PointsView vertices, const Triangles& triangles) {
  std::vector<Facet> out;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    out.push_back({vertices[triangles.a[t]].cast<double>(), vertices[triangles.b[t]].cast<double>(),
                   vertices[triangles.c[t]].cast<double>()});
  }
  return out;
}

/// Height of a facet's plane over (x, y); NaN for a vertical one.
inline double height_at(const Facet& f, double x, double y) {
  const Eigen::Vector3d n = (f[1] - f[0]).cross(f[2] - f[0]);
  return f[0].z() - (n.x() * (x - f[0].x()) + n.y() * (y - f[0].y())) / n.z();
}

/// Smallest height of one facet above another where both cover the plane. It occurs at a corner of
/// the polygon that both cover: the outline of one facet, clipped along each side of the other.
/// Infinite without a common polygon. Vertical facets have no area in the plane and are left out:
/// their edges also belong to other facets.
inline double clearance(const Facet& upper, const Facet& lower) {
  using Eigen::Vector2d;
  const auto area = [](const Vector2d& a, const Vector2d& b, const Vector2d& c) {
    return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
  };
  std::vector<Vector2d> polygon;
  for (const Eigen::Vector3d& corner : upper) polygon.push_back(corner.head<2>());
  std::array<Vector2d, 3> knife{lower[0].head<2>(), lower[1].head<2>(), lower[2].head<2>()};
  const double knife_area = area(knife[0], knife[1], knife[2]);
  if (std::abs(knife_area) < 1e-14 || std::abs(area(polygon[0], polygon[1], polygon[2])) < 1e-14) {
    return std::numeric_limits<double>::infinity();
  }
  if (knife_area < 0) std::swap(knife[1], knife[2]);
  for (std::size_t side = 0; side < 3; ++side) {
    const Vector2d from = knife[side], to = knife[(side + 1) % 3];
    std::vector<Vector2d> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vector2d a = polygon[i], b = polygon[(i + 1) % polygon.size()];
      const double inside_a = area(from, to, a), inside_b = area(from, to, b);
      if (inside_a >= 0) kept.push_back(a);
      if ((inside_a >= 0) != (inside_b >= 0))
        kept.push_back(a + (b - a) * (inside_a / (inside_a - inside_b)));
    }
    polygon = kept;
  }
  double least = std::numeric_limits<double>::infinity();
  for (const Vector2d& p : polygon) {
    least = std::min(least, height_at(upper, p.x(), p.y()) - height_at(lower, p.x(), p.y()));
  }
  return least;
}

/// Smallest clearance of one mesh above another.
inline double clearance(const std::vector<Facet>& upper, const std::vector<Facet>& lower) {
  double least = std::numeric_limits<double>::infinity();
  for (const Facet& a : upper) {
    for (const Facet& b : lower) least = std::min(least, clearance(a, b));
  }
  return least;
}

/// Distance of a point from a triangle.
inline double distance(const Eigen::Vector3d& p, const Facet& f) {
  const Eigen::Vector3d n = (f[1] - f[0]).cross(f[2] - f[0]);
  if (n.norm() > 0) {
    const Eigen::Vector3d unit = n.normalized(), foot = p - unit.dot(p - f[0]) * unit;
    bool inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      inside = inside && (f[(i + 1) % 3] - f[i]).cross(foot - f[i]).dot(n) >= 0;
    }
    if (inside) return (p - foot).norm();
  }
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d along = f[(i + 1) % 3] - f[i];
    const double t = along.squaredNorm() > 0
                         ? std::clamp(along.dot(p - f[i]) / along.squaredNorm(), 0.0, 1.0)
                         : 0;
    least = std::min(least, (p - f[i] - t * along).norm());
  }
  return least;
}

/// The depth of a point inside a closed mesh, 0 outside. Uses the parity of a ray's crossings in a
/// direction that no edge has.
inline double depth_inside(const Eigen::Vector3d& p, const std::vector<Facet>& mesh) {
  const Eigen::Vector3d direction = Eigen::Vector3d(0.5377, 0.2713, 0.7981).normalized();
  int crossings = 0;
  for (const Facet& f : mesh) {
    Eigen::Matrix3d m;
    m << f[1] - f[0], f[2] - f[0], -direction;
    if (std::abs(m.determinant()) < 1e-20) continue;
    const Eigen::Vector3d uvt = m.inverse() * (p - f[0]);
    if (uvt.x() >= 0 && uvt.y() >= 0 && uvt.x() + uvt.y() <= 1 && uvt.z() > 0) ++crossings;
  }
  if (crossings % 2 == 0) return 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const Facet& f : mesh) nearest = std::min(nearest, distance(p, f));
  return nearest;
}

}  // namespace trivet::reference
