/// Meshes with known properties, built without the code under test.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>

#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"

namespace trivet::test {

struct Shape {
  Points vertices;
  Triangles triangles;  // wound so that normals point outward

  void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
    const auto first = static_cast<std::uint32_t>(vertices.size());
    for (const auto& p : {a, b, c}) vertices.push_back(p);
    triangles.push_back(first, first + 1, first + 2);
  }
  void add(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
           const Eigen::Vector3f& d) {
    add(a, b, c);
    add(a, c, d);
  }
  Shape& join(const Shape& other) {
    for (std::size_t t = 0; t < other.triangles.size(); ++t) {
      add(other.vertices[other.triangles.a[t]], other.vertices[other.triangles.b[t]],
          other.vertices[other.triangles.c[t]]);
    }
    return *this;
  }
  Shape moved(const Pose& pose) const {
    Shape out = *this;
    for (std::size_t i = 0; i < vertices.size(); ++i) out.vertices.set(i, pose * vertices[i]);
    return out;
  }
  Shape inside_out() const {
    Shape out = *this;
    std::swap(out.triangles.b, out.triangles.c);
    return out;
  }
};

inline Shape box(const Eigen::Vector3f& low, const Eigen::Vector3f& high) {
  const auto corner = [&](int i) {
    return Eigen::Vector3f((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                           (i & 4) != 0 ? high.z() : low.z());
  };
  Shape shape;
  for (const auto& [a, b, c, d] :
       {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
        std::array{2, 6, 7, 3}, std::array{0, 4, 6, 2}, std::array{1, 3, 7, 5}}) {
    shape.add(corner(a), corner(b), corner(c), corner(d));
  }
  return shape;
}

using Outline = std::function<double(double)>;  ///< radius as a function of the angle

inline Outline circle(double radius) {
  return [=](double) { return radius; };
}
/// A regular polygon with corners at radius 1.
inline Outline polygon(int corners) {
  return [=](double angle) {
    const double side = 2 * std::numbers::pi / corners;
    return std::cos(side / 2) / std::cos(std::fmod(angle + 1e-9, side) - side / 2);
  };
}
/// Rectangular teeth whose height is this fraction of the radius.
inline Outline teeth(int count, double height) {
  return [=](double angle) { return 1 + (std::cos(count * angle) > 0 ? height : -height); };
}

/// An outline extruded from z = low to high, where it is scaled by `top`, with an optional bore.
inline Shape prism(int segments, const Outline& outline, double low, double high, double bore = 0,
                   double top = 1) {
  Shape shape;
  const auto at = [](double radius, double angle, double z) {
    return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), z)
        .cast<float>()
        .eval();
  };
  for (int i = 0; i < segments; ++i) {
    const double a = 2 * std::numbers::pi * i / segments;
    const double b = 2 * std::numbers::pi * (i + 1) / segments;
    const double ra = outline(a), rb = outline(b);
    shape.add(at(ra, a, low), at(rb, b, low), at(top * rb, b, high), at(top * ra, a, high));
    if (bore > 0) {
      shape.add(at(bore, a, low), at(bore, a, high), at(bore, b, high), at(bore, b, low));
    }
    shape.add(at(top * ra, a, high), at(top * rb, b, high), at(bore, b, high), at(bore, a, high));
    shape.add(at(ra, a, low), at(bore, a, low), at(bore, b, low), at(rb, b, low));
  }
  return shape;
}

/// An ellipsoid with these half axes.
inline Shape ellipsoid(const Eigen::Vector3f& axes, int rings = 60) {
  Shape shape;
  const auto at = [&](int i, int j) {
    const double a = std::numbers::pi * i / rings, b = std::numbers::pi * j / rings;
    return Eigen::Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a))
        .cast<float>()
        .cwiseProduct(axes)
        .eval();
  };
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < 2 * rings; ++j) {
      shape.add(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return shape;
}

inline Shape tetrahedron() {
  const Eigen::Vector3f a(1, 1, 1), b(-1, -1, 1), c(-1, 1, -1), d(1, -1, -1);
  Shape shape;
  shape.add(a, c, b);
  shape.add(a, b, d);
  shape.add(a, d, c);
  shape.add(b, c, d);
  return shape;
}

}  // namespace trivet::test
