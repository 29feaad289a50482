#include "kernels/simulation/solid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Matrix3f;
using Eigen::Vector2f;
using Eigen::Vector3f;
using Values = std::array<float, 12>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

SolidSample smaller(const SolidSample& a, const SolidSample& b) noexcept {
  return a.distance <= b.distance ? a : b;
}
SolidSample larger(const SolidSample& a, const SolidSample& b) noexcept {
  return a.distance >= b.distance ? a : b;
}

SolidSample smooth_minimum(const SolidSample& a, const SolidSample& b, float radius) noexcept {
  const SolidSample &low = a.distance <= b.distance ? a : b, &high = &low == &a ? b : a;
  const float overlap = std::max(0.0F, 1 - (high.distance - low.distance) / radius);
  return {low.distance - overlap * overlap * radius / 4,
          low.gradient + overlap / 2 * (high.gradient - low.gradient)};
}

struct Placement {
  Eigen::Map<const Matrix3f> rotation;
  Eigen::Map<const Vector3f> translation;
  explicit Placement(const Values& v) : rotation(v.data()), translation(v.data() + 9) {}
};

/// The rotation about z that moves a point to the sector of the first copy, and its side there.
struct Fold {
  float half_step, cosine, sine, side;

  Fold(const Vector3f& p, float count) noexcept : half_step(std::numbers::pi_v<float> / count) {
    const float step = 2 * half_step;
    const float turn = step * std::round(std::atan2(p.y(), p.x()) / step);
    cosine = std::cos(turn);
    sine = std::sin(turn);
    side = cosine * p.y() - sine * p.x() < 0 ? -1.0F : 1.0F;
  }
  Vector3f apply(const Vector3f& p) const noexcept {
    return {cosine * p.x() + sine * p.y(), side * (cosine * p.y() - sine * p.x()), p.z()};
  }
  Vector3f undo(const Vector3f& v) const noexcept {
    return {cosine * v.x() - sine * side * v.y(), sine * v.x() + cosine * side * v.y(), v.z()};
  }
  /// The linear map of `apply` for all points of this sector.
  Matrix3f matrix() const noexcept {
    return Matrix3f{{cosine, sine, 0}, {-side * sine, side * cosine, 0}, {0, 0, 1}};
  }
  /// Distance of a transformed point from the nearest border to another sector or side.
  float distance_to_sides(const Vector3f& p) const noexcept {
    return std::min(p.y(), std::sin(half_step) * p.x() - std::cos(half_step) * p.y());
  }
};

Vector3f mirror_x(const Vector3f& p) noexcept { return {-p.x(), p.y(), p.z()}; }

/// Unit vector; along x for a zero vector.
Vector2f direction(const Vector2f& v, float length) noexcept {
  return length > 0 ? Vector2f(v / length) : Vector2f::UnitX();
}

SolidSample box_sample(const Values& half_sides, const Vector3f& p) noexcept {
  SolidSample out{-kInfinity, Vector3f::Zero()};
  for (int k = 0; k < 3; ++k) {
    const float distance = std::abs(p[k]) - half_sides[static_cast<std::size_t>(k)];
    if (distance > out.distance) out = {distance, std::copysign(1.0F, p[k]) * Vector3f::Unit(k)};
  }
  return out;
}

/// values: (n_r, n_z) unit normal in the half plane through the axis, offset along it.
SolidSample turned_edge_sample(const Values& v, const Vector3f& p) noexcept {
  const Vector2f radial = p.head<2>();
  const float radius = radial.norm();
  Vector3f gradient(0, 0, v[1]);
  gradient.head<2>() = v[0] * direction(radial, radius);
  return {v[0] * radius + v[1] * p.z() - v[2], gradient};
}

SolidSample torus_sample(const Values& v, const Vector3f& p) noexcept {
  const Vector2f radial = p.head<2>();
  const float radius = radial.norm();
  const Vector2f off(radius - v[0], p.z());
  const float length = off.norm();
  const Vector2f along = direction(off, length);
  Vector3f gradient(0, 0, along.y());
  gradient.head<2>() = along.x() * direction(radial, radius);
  return {length - v[1], gradient};
}

/// values: r0, r1, length, and the normal (c, s) of the upper side of the hull, c = (r0 - r1) /
/// length. The position along the side determines whether a disc or the side is nearest.
SolidSample oblong_sample(const Values& v, const Vector3f& p) noexcept {
  const float c = v[3], s = v[4], y = std::abs(p.y());
  const float along = s * p.x() - c * y;  // from the point where the side leaves the first disc
  Vector2f gradient(c, s);
  float distance = c * p.x() + s * y - v[0];
  if (along < 0 || along > s * v[2]) {
    const bool first = along < 0;
    const Vector2f from_center(first ? p.x() : p.x() - v[2], y);
    const float length = from_center.norm();
    gradient = direction(from_center, length);
    distance = length - (first ? v[0] : v[1]);
  }
  return {distance, {gradient.x(), std::copysign(gradient.y(), p.y()), 0}};
}

}  // namespace

Solid::Solid(const Node& node, const Solid& a, const AlignedBox3f& bounds) : Solid(node, bounds) {
  nodes_.insert(nodes_.end(), a.nodes_.begin(), a.nodes_.end());
}
Solid::Solid(const Node& node, const Solid& a, const Solid& b, const AlignedBox3f& bounds)
    : Solid(node, a, bounds) {
  nodes_.insert(nodes_.end(), b.nodes_.begin(), b.nodes_.end());
}

AlignedBox3f Solid::everywhere() {
  return {Vector3f::Constant(-kInfinity), Vector3f::Constant(kInfinity)};
}

SolidSample Solid::sample(const Vector3f& point) const noexcept {
  const Node* node = nodes_.data();
  return evaluate(node, point);
}

// Evaluates one expression; `node` then points behind it.
SolidSample Solid::evaluate(const Node*& node, const Vector3f& p) noexcept {
  const Node& here = *node++;
  switch (here.kind) {
    case Kind::unite: {
      const SolidSample a = evaluate(node, p);
      return smaller(a, evaluate(node, p));
    }
    case Kind::intersect: {
      const SolidSample a = evaluate(node, p);
      return larger(a, evaluate(node, p));
    }
    case Kind::blend: {
      const SolidSample a = evaluate(node, p);
      return smooth_minimum(a, evaluate(node, p), here.values[0]);
    }
    case Kind::complement: {
      const SolidSample a = evaluate(node, p);
      return {-a.distance, -a.gradient};
    }
    case Kind::motion: {
      const Placement inverse(here.values);
      const SolidSample a = evaluate(node, inverse.rotation * p + inverse.translation);
      return {a.distance, inverse.rotation.transpose() * a.gradient};
    }
    case Kind::mirror_x: {
      const SolidSample a = evaluate(node, trivet::kernels::mirror_x(p));
      return {a.distance, trivet::kernels::mirror_x(a.gradient)};
    }
    case Kind::around: {
      const Fold fold(p, here.values[0]);
      const SolidSample a = evaluate(node, fold.apply(p));
      return {a.distance, fold.undo(a.gradient)};
    }
    default:
      return evaluate_leaf(here, p);
  }
}

SolidSample Solid::evaluate_leaf(const Node& node, const Vector3f& p) noexcept {
  const Values& v = node.values;
  switch (node.kind) {
    case Kind::half_space: {
      const Vector3f normal(v[0], v[1], v[2]);
      return {normal.dot(p) - v[3], normal};
    }
    case Kind::turned_edge:
      return turned_edge_sample(v, p);
    case Kind::torus:
      return torus_sample(v, p);
    case Kind::oblong:
      return oblong_sample(v, p);
    default:
      return box_sample(v, p);
  }
}

float Solid::restrict_to(const Vector3f& point, float radius, Solid& out) const {
  out.nodes_.clear();
  out.bounds_ = bounds_;
  const Node* node = nodes_.data();
  return restrict_node(node, point, radius, out.nodes_);
}

// Values change by at most the radius: of two that differ by more than twice that, one decides.
float Solid::restrict_node(const Node*& node, const Vector3f& p, float radius,
                           std::vector<Node>& out) {
  const Node& here = *node++;
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  out.push_back(here);
  switch (here.kind) {
    case Kind::unite:
    case Kind::intersect:
    case Kind::blend: {
      const float a = restrict_node(node, p, radius, out);
      const auto second = static_cast<std::ptrdiff_t>(out.size());
      const float b = restrict_node(node, p, radius, out);
      const float margin = 2 * radius + (here.kind == Kind::blend ? here.values[0] : 0);
      if (std::abs(a - b) <= margin) {
        if (here.kind == Kind::blend)
          return smooth_minimum({a, {}}, {b, {}}, here.values[0]).distance;
      } else if ((a < b) == (here.kind != Kind::intersect)) {
        out.erase(out.begin() + second, out.end());
        out.erase(out.begin() + first);
      } else {
        out.erase(out.begin() + first, out.begin() + second);
      }
      return here.kind == Kind::intersect ? std::max(a, b) : std::min(a, b);
    }
    case Kind::complement:
      return -restrict_node(node, p, radius, out);
    case Kind::motion: {
      const Placement inverse(here.values);
      return restrict_node(node, inverse.rotation * p + inverse.translation, radius, out);
    }
    case Kind::mirror_x:
      return restrict_node(node, trivet::kernels::mirror_x(p), radius, out);
    case Kind::around: {
      const Fold fold(p, here.values[0]);
      const Vector3f folded = fold.apply(p);
      if (fold.distance_to_sides(folded) > radius) {
        Node& turn = out.back();
        turn.kind = Kind::motion;
        Eigen::Map<Matrix3f>(turn.values.data()) = fold.matrix();
        Eigen::Map<Vector3f>(turn.values.data() + 9).setZero();
      }
      return restrict_node(node, folded, radius, out);
    }
    default:
      return evaluate_leaf(here, p).distance;
  }
}

Solid operator|(const Solid& a, const Solid& b) {
  return {{Solid::Kind::unite, {}}, a, b, a.bounds_.merged(b.bounds_)};
}

Solid operator&(const Solid& a, const Solid& b) {
  return {{Solid::Kind::intersect, {}}, a, b, a.bounds_.intersection(b.bounds_)};
}

Solid operator~(const Solid& a) { return {{Solid::Kind::complement, {}}, a, Solid::everywhere()}; }

Solid blend(const Solid& a, const Solid& b, float radius) {
  AlignedBox3f bounds = a.bounds_.merged(b.bounds_);
  bounds.min().array() -= radius / 4;
  bounds.max().array() += radius / 4;
  return {{Solid::Kind::blend, {radius}}, a, b, bounds};
}

Solid moved(const Solid& a, const Pose& motion) {
  const Pose inverse = motion.inverse();
  Solid::Node node{Solid::Kind::motion, {}};
  Eigen::Map<Matrix3f>(node.values.data()) = inverse.linear();
  Eigen::Map<Vector3f>(node.values.data() + 9) = inverse.translation();
  if (a.bounds_.sizes().array().isInf().any()) return {node, a, Solid::everywhere()};
  AlignedBox3f bounds;
  for (int corner = 0; corner < 8; ++corner) {
    bounds.extend(motion * a.bounds_.corner(static_cast<AlignedBox3f::CornerType>(corner)));
  }
  return {node, a, bounds};
}

Solid mirrored_x(const Solid& a) {
  AlignedBox3f bounds = a.bounds_;
  bounds.min().x() = -a.bounds_.max().x();
  bounds.max().x() = -a.bounds_.min().x();
  return {{Solid::Kind::mirror_x, {}}, a, bounds};
}

Solid around_z(const Solid& a, std::uint32_t count) {
  const Vector3f reach = a.bounds_.min().cwiseAbs().cwiseMax(a.bounds_.max().cwiseAbs());
  const float radius = reach.head<2>().norm();
  AlignedBox3f bounds = a.bounds_;
  bounds.min().head<2>().setConstant(-radius);
  bounds.max().head<2>().setConstant(radius);
  return {{Solid::Kind::around, {static_cast<float>(count)}}, a, bounds};
}

Solid half_space(const Vector3f& normal, float offset) {
  AlignedBox3f bounds = Solid::everywhere();
  for (int k = 0; k < 3; ++k) {
    if (normal == Vector3f::Unit(k)) bounds.max()[k] = offset;
    if (normal == -Vector3f::Unit(k)) bounds.min()[k] = -offset;
  }
  return {{Solid::Kind::half_space, {normal.x(), normal.y(), normal.z(), offset}}, bounds};
}

Solid box(const Vector3f& half_sides) {
  return {{Solid::Kind::box, {half_sides.x(), half_sides.y(), half_sides.z()}},
          {-half_sides, half_sides}};
}

Solid turned(std::span<const Vector2f> profile) {
  Eigen::AlignedBox2f extent;
  for (const Vector2f& corner : profile) extent.extend(corner);
  const AlignedBox3f bounds(Vector3f(-extent.max().x(), -extent.max().x(), extent.min().y()),
                            Vector3f(extent.max().x(), extent.max().x(), extent.max().y()));
  std::optional<Solid> out;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vector2f from = profile[i], to = profile[(i + 1) % profile.size()];
    if (from.x() == 0 && to.x() == 0) continue;
    const Vector2f normal = Vector2f(to.y() - from.y(), from.x() - to.x()).normalized();
    const Solid edge({Solid::Kind::turned_edge, {normal.x(), normal.y(), normal.dot(from)}},
                     bounds);
    out = out ? *out & edge : edge;
  }
  TRIVET_REQUIRE(out, "a profile has an edge off the axis");
  return *out;
}

Solid torus(float radius, float thickness) {
  const float reach = radius + thickness;
  return {{Solid::Kind::torus, {radius, thickness}},
          {Vector3f(-reach, -reach, -thickness), Vector3f(reach, reach, thickness)}};
}

Solid oblong(float r0, float r1, float length) {
  const float c = (r0 - r1) / length, reach = std::max(r0, r1);
  return {{Solid::Kind::oblong, {r0, r1, length, c, std::sqrt(1 - c * c)}},
          {Vector3f(std::min(-r0, length - r1), -reach, -kInfinity),
           Vector3f(std::max(r0, length + r1), reach, kInfinity)}};
}

}  // namespace trivet::kernels
