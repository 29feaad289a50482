/// Solids as signed distance functions, composed of a few primitives.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/model.hpp"

namespace trivet::kernels {

/// A signed bound of the distance to a surface, and its gradient.
struct SolidSample {
  float distance = 0;                 ///< signed bound; negative inside
  Eigen::Vector3f gradient{0, 0, 0};  ///< length at most 1; exactly 1 outside of blends
};

/// A solid in any unit: a function whose sign distinguishes inside from outside and whose value
/// changes no faster than the distance (Lipschitz bound 1). So |value| is the radius of a ball
/// without surface.
///
/// Stored as one flat expression in prefix order; copies are independent. Evaluation does not
/// allocate. Composition uses minima and maxima: edges stay sharp, symmetries stay exact.
/// Source: Hart, "Sphere tracing", The Visual Computer 1996 (Lipschitz bounds of set operations).
class Solid {
 public:
  SolidSample sample(const Eigen::Vector3f& point) const noexcept;
  float distance(const Eigen::Vector3f& point) const noexcept { return sample(point).distance; }

  /// Bounding box of the solid; its sides may be infinite.
  const Eigen::AlignedBox3f& bounds() const noexcept { return bounds_; }

  /// Write the parts that matter within a radius of a point: there `out` has this solid's values
  /// and is faster to evaluate. Returns the distance at the point. The memory of `out` is reused.
  float restrict_to(const Eigen::Vector3f& point, float radius, Solid& out) const;

  friend Solid operator|(const Solid& a, const Solid& b);
  friend Solid operator&(const Solid& a, const Solid& b);
  friend Solid operator~(const Solid& a);
  friend Solid blend(const Solid& a, const Solid& b, float radius);
  friend Solid moved(const Solid& a, const Pose& motion);
  friend Solid mirrored_x(const Solid& a);
  friend Solid around_z(const Solid& a, std::uint32_t count);
  friend Solid half_space(const Eigen::Vector3f& normal, float offset);
  friend Solid box(const Eigen::Vector3f& half_sides);
  friend Solid turned(std::span<const Eigen::Vector2f> profile);
  friend Solid torus(float radius, float thickness);
  friend Solid oblong(float r0, float r1, float length);

 private:
  enum class Kind : std::uint8_t {
    unite,
    intersect,
    blend,  // followed by two operands
    complement,
    motion,
    mirror_x,
    around,  // followed by one operand
    half_space,
    box,
    turned_edge,
    torus,
    oblong  // without operands
  };
  struct Node {
    Kind kind = Kind::box;
    std::array<float, 12> values{};  // motion: rotation by columns, translation, both inverse
  };

  Solid(const Node& node, const Eigen::AlignedBox3f& bounds) : nodes_{node}, bounds_(bounds) {}
  Solid(const Node& node, const Solid& a, const Eigen::AlignedBox3f& bounds);
  Solid(const Node& node, const Solid& a, const Solid& b, const Eigen::AlignedBox3f& bounds);

  static Eigen::AlignedBox3f everywhere();
  static SolidSample evaluate(const Node*& node, const Eigen::Vector3f& p) noexcept;
  static SolidSample evaluate_leaf(const Node& node, const Eigen::Vector3f& p) noexcept;
  static float restrict_node(const Node*& node, const Eigen::Vector3f& p, float radius,
                             std::vector<Node>& out);

  std::vector<Node> nodes_;
  Eigen::AlignedBox3f bounds_;
};

/// Union, intersection, complement, difference.
Solid operator|(const Solid& a, const Solid& b);
Solid operator&(const Solid& a, const Solid& b);
Solid operator~(const Solid& a);
inline Solid operator-(const Solid& a, const Solid& b) { return a & ~b; }

/// Union with a fillet of about this radius in the concave corner. Coplanar faces of both swell
/// there by a quarter of the radius; keep them apart by more than the radius.
/// Source: quadratic smooth minimum (Quilez, "Smooth minimum").
Solid blend(const Solid& a, const Solid& b, float radius);

Solid moved(const Solid& a, const Pose& motion);

/// The mirror image in the plane x = 0.
Solid mirrored_x(const Solid& a);

/// Copies of the part of `a` at angles 0 to pi / count about the z axis from +x, and of its mirror
/// image in y, at `count` equal rotations: the result has the symmetries of a regular pyramid.
Solid around_z(const Solid& a, std::uint32_t count);

/// Points p with normal . p <= offset; the normal has unit length.
Solid half_space(const Eigen::Vector3f& normal, float offset);

/// A box about the origin; a half side may be infinite.
Solid box(const Eigen::Vector3f& half_sides);

/// A convex profile revolved about the z axis: corners (distance from the axis >= 0, z) in
/// counterclockwise order. Edges on the axis are no border.
Solid turned(std::span<const Eigen::Vector2f> profile);

/// A ring about the z axis: points within `thickness` of a circle of radius `radius`.
Solid torus(float radius, float thickness);

/// An infinite prism along z: the hull of a disc of radius r0 at the origin and one of radius r1 at
/// (length, 0). Pre: length > |r0 - r1|.
Solid oblong(float r0, float r1, float length);

}  // namespace trivet::kernels
