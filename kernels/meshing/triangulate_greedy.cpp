#include "kernels/meshing/triangulate_greedy.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "kernels/common/median.hpp"
#include "kernels/common/nearest_neighbors.hpp"
#include "kernels/common/voxel_hash.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint32_t kNoWedge = 0xFFFFFFFF;
constexpr std::size_t kFanNeighbors = 8;
// Largest height of a neighbor over the tangent plane, in spacings: with noise of 0.4 spacings, 98
// of 100 points pass, and no sheets two spacings apart are joined.
constexpr double kMaxHeight = 1;
constexpr double kFullTurn = 2 * std::numbers::pi;

double radians(float degrees) { return degrees * std::numbers::pi / 180; }

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// The counter-clockwise angle from one direction to another, above 0 to a full turn.
double turn(double from, double to) {
  const double angle = to - from;
  return angle > 0 ? angle : angle + kFullTurn;
}

/// The triangles about each point, which form its fan.
class Fans {
 public:
  /// A triangle relative to one of its corners: the other two, counter-clockwise.
  struct Wedge {
    std::uint32_t from, to;
    std::uint32_t next;  // next wedge of the same point
  };

  explicit Fans(std::size_t n) : first_(n, kNoWedge), num_borders_(n, 0) { wedges_.reserve(6 * n); }

  bool is_empty(std::uint32_t v) const { return first_[v] == kNoWedge; }
  /// Whether triangles surround a point.
  bool is_closed(std::uint32_t v) const { return !is_empty(v) && num_borders_[v] == 0; }

  template <class Visit>
  void visit(std::uint32_t v, Visit&& visit) const {
    for (std::uint32_t w = first_[v]; w != kNoWedge; w = wedges_[w].next) visit(wedges_[w]);
  }
  template <class Condition>
  bool any(std::uint32_t v, Condition&& condition) const {
    for (std::uint32_t w = first_[v]; w != kNoWedge; w = wedges_[w].next) {
      if (condition(wedges_[w])) return true;
    }
    return false;
  }
  /// Whether a triangle has this edge, in this direction.
  bool has_edge(std::uint32_t from, std::uint32_t to) const {
    return any(from, [&](const Wedge& wedge) { return wedge.from == to; });
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    add_wedge(a, b, c);
    add_wedge(b, c, a);
    add_wedge(c, a, b);
  }

 private:
  void add_wedge(std::uint32_t v, std::uint32_t from, std::uint32_t to) {
    const bool meets_from = any(v, [&](const Wedge& wedge) { return wedge.to == from; });
    num_borders_[v] += (meets_from ? -1 : 1) + (has_edge(v, to) ? -1 : 1);
    wedges_.push_back({from, to, first_[v]});
    first_[v] = static_cast<std::uint32_t>(wedges_.size() - 1);
  }

  Column<std::uint32_t> first_;       // first wedge of each point
  Column<std::int32_t> num_borders_;  // per point: edges with only one triangle
  Column<Wedge> wedges_;
};

/// The plane through a point perpendicular to its normal.
struct TangentPlane {
  Vector3d origin, x, y;

  Vector2d project(const Vector3d& p) const { return {x.dot(p - origin), y.dot(p - origin)}; }
};

/// A neighbor of the fan's center, in its tangent plane.
struct Neighbor {
  std::uint32_t index;
  Vector2d at;
  double turned = 0;  // counter-clockwise angle from the start of the gap

  double angle() const { return std::atan2(at.y(), at.x()); }
  /// Inversion in the unit circle: maps circles through the origin to lines.
  Vector2d inverted() const { return at / at.squaredNorm(); }
};

/// An edge with only one triangle, in the tangent plane.
struct Border {
  std::uint32_t from, to;
  Vector2d a, b;
};

/// The surface grown so far.
class Growth {
 public:
  Growth(PointsView points, NormalsView normals, const GreedyOptions& options)
      : points_(points),
        options_(options),
        min_angle_(radians(options.min_angle_deg)),
        max_angle_(radians(options.max_angle_deg)),
        min_cosine_(std::cos(radians(options.max_normal_angle_deg))),
        fans_(points.size()) {
    normals_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      normals_.push_back(normals[i].cast<double>().normalized());
  }

  /// Errors: no_memory.
  Result<void> measure();
  Triangles grow();

 private:
  Vector3d position(std::uint32_t v) const { return points_[v].cast<double>(); }
  TangentPlane tangent_plane(std::uint32_t v) const;
  bool are_alike(std::uint32_t v, std::uint32_t w) const {
    return normals_[v].dot(normals_[w]) >= min_cosine_;
  }
  /// The longest edge at a point.
  double reach(std::uint32_t v) const {
    return std::min<double>(options_.radius, options_.mu * spacings_[v]);
  }
  bool is_in_reach(std::uint32_t v, std::uint32_t w) const {
    return (position(v) - position(w)).norm() <= std::min(reach(v), reach(w));
  }
  bool is_level(std::uint32_t v, std::uint32_t w) const {
    return std::abs(normals_[v].dot(position(w) - position(v))) <= kMaxHeight * spacings_[v];
  }

  void complete(std::uint32_t p);
  void gather(std::uint32_t p);
  void find_borders();
  bool is_covered() const;
  bool may_join(std::uint32_t p, const Neighbor& q) const;
  void close_gap(std::uint32_t p, const Neighbor& first, const Neighbor& last, double width);
  void keep_delaunay_neighbors();
  void add_triangle(std::uint32_t p, const Neighbor& a, const Neighbor& b);
  Neighbor project(std::uint32_t v) const { return {v, plane_.project(position(v))}; }
  bool crosses_border(const Neighbor& p, const Neighbor& q) const;
  bool is_narrow(const std::array<std::uint32_t, 3>& corners) const;
  bool is_open_towards(std::uint32_t v, std::uint32_t w) const;
  bool fits(std::uint32_t v, std::uint32_t from, std::uint32_t to) const;

  PointsView points_;
  GreedyOptions options_;
  double min_angle_, max_angle_, min_cosine_;
  std::vector<Vector3d> normals_;
  Column<double> spacings_;  // 0 for unused points
  VoxelHash grid_;
  Fans fans_;
  Triangles triangles_;
  std::vector<std::uint32_t> front_;
  std::size_t num_completed_ = 0;  // number of completed points of the front
  std::vector<std::uint8_t> is_reached_;

  // State of the current fan.
  TangentPlane plane_;
  std::vector<std::pair<float, std::uint32_t>> near_;
  std::vector<Neighbor> neighbors_;
  std::vector<Border> borders_;
  std::vector<Neighbor> starts_, ends_, chain_, kept_;
};

Result<void> Growth::measure() {
  // Usable points: finite, with a normal, the first at their position.
  Points places;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    if (!points_[i].allFinite() || !normals_[i].allFinite() || normals_[i].isZero()) continue;
    order.push_back(i);
  }
  const auto coordinates = [&](std::uint32_t i) {
    return std::array{points_.x[i], points_.y[i], points_.z[i]};
  };
  std::ranges::sort(order, [&](std::uint32_t i, std::uint32_t j) {
    const auto a = coordinates(i), b = coordinates(j);
    return a != b ? a < b : i < j;
  });
  const auto is_same_place = [&](std::uint32_t i, std::uint32_t j) {
    return coordinates(i) == coordinates(j);
  };
  order.erase(std::unique(order.begin(), order.end(), is_same_place), order.end());
  std::ranges::sort(order);
  for (const std::uint32_t i : order) places.push_back(points_[i]);

  spacings_.assign(points_.size(), 0);
  const std::size_t n = places.size(), k = std::min(2 * kFanNeighbors + 1, n);
  if (n < 3) return {};
  TRIVET_TRY_ASSIGN(const NearestNeighbors tree, NearestNeighbors::build(places));
  std::vector<std::uint32_t> nearest(k * n);
  std::vector<float> squared(k * n);
  TRIVET_TRY(tree.k_nearest(places, k, nearest, squared));

  // The spacing is the step of the square lattice with the same distance to the eighth neighbor, or
  // the same density. The other side of a thin wall is excluded.
  const auto visit_alike = [&](std::size_t i, auto&& visit) {
    std::size_t num_alike = 0;
    for (std::size_t j = 1; j < k && num_alike < kFanNeighbors; ++j) {
      if (are_alike(order[i], order[nearest[k * i + j]]))
        visit(nearest[k * i + j], squared[k * i + j], ++num_alike);
    }
  };
  std::vector<double> own(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    visit_alike(i, [&](std::size_t, double d2, std::size_t count) {
      own[i] = 2 * std::sqrt(d2 / static_cast<double>(count));
    });
  }
  Column<float> found;
  for (std::size_t i = 0; i < n; ++i) {
    // Isolated points may reach no farther than their neighbors do, not into the midst of those.
    double widest = 0;
    visit_alike(i, [&](std::size_t j, double, std::size_t) { widest = std::max(widest, own[j]); });
    spacings_[order[i]] = std::min(own[i], widest);
    if (widest > 0) found.push_back(static_cast<float>(reach(order[i])));
  }
  if (found.empty()) return {};
  const float cell = median(std::span(found));
  Points used(points_.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    used.set(i, spacings_[i] > 0 ? points_[i] : Eigen::Vector3f::Constant(NAN));
  }
  grid_ = VoxelHash(used, cell);
  return {};
}

TangentPlane Growth::tangent_plane(std::uint32_t v) const {
  // The axis farthest from the normal makes the plane's axes well defined.
  Eigen::Index axis = 0;
  normals_[v].cwiseAbs().minCoeff(&axis);
  const Vector3d x = normals_[v].cross(Vector3d::Unit(axis)).normalized();
  return {position(v), x, normals_[v].cross(x)};
}

/// Collect the points to which edges of p may lead, or which may be hidden by them.
void Growth::gather(std::uint32_t p) {
  near_.clear();
  grid_.visit_within(points_[p], static_cast<float>(reach(p)), [&](std::uint32_t i, float d2) {
    if (i != p && are_alike(p, i) && is_level(p, i)) near_.emplace_back(d2, i);
  });
  const std::size_t count = std::min<std::size_t>(options_.max_neighbors, near_.size());
  std::ranges::nth_element(near_, near_.begin() + static_cast<std::ptrdiff_t>(count));
  near_.resize(count);
  neighbors_.clear();
  for (const auto& [d2, i] : near_) {
    const Neighbor q = project(i);
    if (!q.at.isZero(0)) neighbors_.push_back(q);  // otherwise it has no direction
  }
}

/// Collect the boundary edges around p: nothing is visible beyond them.
void Growth::find_borders() {
  borders_.clear();
  for (const Neighbor& q : neighbors_) {
    if (fans_.is_closed(q.index)) continue;
    fans_.visit(q.index, [&](const Fans::Wedge& wedge) {
      if (!fans_.has_edge(wedge.from, q.index))
        borders_.push_back({q.index, wedge.from, q.at, project(wedge.from).at});
      if (!fans_.has_edge(q.index, wedge.to))
        borders_.push_back({wedge.to, q.index, project(wedge.to).at, q.at});
    });
  }
}

/// Whether the point, which has no triangle, lies inside a triangle of its neighbors.
bool Growth::is_covered() const {
  return std::ranges::any_of(neighbors_, [&](const Neighbor& q) {
    return fans_.any(q.index, [&](const Fans::Wedge& wedge) {
      const Vector2d a = project(wedge.from).at, b = project(wedge.to).at;
      return cross(q.at, a) >= 0 && cross(a, b) >= 0 && cross(b, q.at) >= 0;
    });
  });
}

/// Whether a segment crosses a border with which it shares no end.
bool Growth::crosses_border(const Neighbor& p, const Neighbor& q) const {
  const Vector2d along = q.at - p.at;
  return std::ranges::any_of(borders_, [&](const Border& border) {
    if (border.from == p.index || border.from == q.index || border.to == p.index ||
        border.to == q.index) {
      return false;
    }
    const double a = cross(along, border.a - p.at), b = cross(along, border.b - p.at);
    if ((a > 0 && b > 0) || (a < 0 && b < 0)) return false;
    const Vector2d edge = border.b - border.a;
    const double c = cross(edge, p.at - border.a), d = cross(edge, q.at - border.a);
    if ((c > 0 && d > 0) || (c < 0 && d < 0)) return false;
    if (a != 0 || b != 0) return true;
    // All four are collinear: they overlap unless one ends before the other begins.
    const double s = along.dot(border.a - p.at), t = along.dot(border.b - p.at);
    return std::max(s, t) >= 0 && std::min(s, t) <= along.squaredNorm();
  });
}

/// Whether the fan of v has a gap for an edge to w.
bool Growth::is_open_towards(std::uint32_t v, std::uint32_t w) const {
  if (fans_.is_empty(v)) return true;
  const TangentPlane plane = tangent_plane(v);
  const Vector2d d = plane.project(position(w));
  return !fans_.any(v, [&](const Fans::Wedge& wedge) {
    return cross(plane.project(position(wedge.from)), d) > 0 &&
           cross(d, plane.project(position(wedge.to))) > 0;
  });
}

/// Whether the fan of v has a gap for a triangle with edges towards `from` and `to`.
bool Growth::fits(std::uint32_t v, std::uint32_t from, std::uint32_t to) const {
  const TangentPlane plane = tangent_plane(v);
  const Vector2d a = plane.project(position(from)), b = plane.project(position(to));
  if (!(cross(a, b) > 0)) return false;
  return !fans_.any(v, [&](const Fans::Wedge& wedge) {
    if (wedge.from == from || wedge.to == to) return true;
    const Vector2d c = plane.project(position(wedge.from)), d = plane.project(position(wedge.to));
    const auto is_within = [](const Vector2d& x, const Vector2d& low, const Vector2d& high) {
      return cross(low, x) > 0 && cross(x, high) > 0;
    };
    return (wedge.from != to && (is_within(c, a, b) || is_within(b, c, d))) ||
           (wedge.to != from && (is_within(d, a, b) || is_within(a, c, d)));
  });
}

/// Whether a new edge from p to a point would cross nothing.
bool Growth::may_join(std::uint32_t p, const Neighbor& q) const {
  return is_open_towards(q.index, p) && !crosses_border({p, Vector2d::Zero()}, q);
}

/// Whether a triangle has too small an angle.
bool Growth::is_narrow(const std::array<std::uint32_t, 3>& corners) const {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector3d at = position(corners[k]);
    const Vector3d a = position(corners[(k + 1) % 3]) - at, b = position(corners[(k + 2) % 3]) - at;
    if (std::atan2(a.cross(b).norm(), a.dot(b)) < min_angle_) return true;
  }
  return false;
}

void Growth::add_triangle(std::uint32_t p, const Neighbor& a, const Neighbor& b) {
  if (!fans_.has_edge(b.index, a.index)) {  // a new edge
    if (!is_in_reach(a.index, b.index) || !are_alike(a.index, b.index) || crosses_border(a, b))
      return;
  }
  if (min_angle_ > 0 && is_narrow({p, a.index, b.index})) return;
  if (!fits(p, a.index, b.index) || !fits(a.index, b.index, p) || !fits(b.index, p, a.index))
    return;
  fans_.add(p, a.index, b.index);
  triangles_.push_back(p, a.index, b.index);
  for (const std::uint32_t v : {a.index, b.index}) {
    if (is_reached_[v] != 0) continue;
    is_reached_[v] = 1;
    front_.push_back(v);
  }
}

/// Keep of the chain the point's neighbors in a Delaunay triangulation of the plane: after
/// inversion, the corners of the convex hull. The ends stay.
void Growth::keep_delaunay_neighbors() {
  kept_.clear();
  for (const Neighbor& c : chain_) {
    while (kept_.size() >= 2) {
      const Neighbor &a = kept_[kept_.size() - 2], &b = kept_.back();
      if (c.turned - a.turned >= std::numbers::pi) break;
      if (cross(b.inverted() - a.inverted(), c.inverted() - b.inverted()) > 0) break;
      kept_.pop_back();
    }
    kept_.push_back(c);
  }
  chain_.swap(kept_);
}

/// Close the gap of a fan, counter-clockwise from one neighbor to another.
void Growth::close_gap(std::uint32_t p, const Neighbor& first, const Neighbor& last, double width) {
  const double first_angle = first.angle();
  chain_.assign(1, first);
  for (Neighbor q : neighbors_) {
    if (q.index == first.index || q.index == last.index || fans_.is_closed(q.index) ||
        !is_in_reach(p, q.index)) {
      continue;
    }
    q.turned = turn(first_angle, q.angle());
    if (q.turned >= width || !may_join(p, q)) continue;
    if (fans_.any(p, [&](auto& wedge) { return wedge.from == q.index || wedge.to == q.index; }))
      continue;
    chain_.push_back(q);
  }
  std::sort(chain_.begin() + 1, chain_.end(), [](const Neighbor& a, const Neighbor& b) {
    if (a.turned != b.turned) return a.turned < b.turned;
    const double near_a = a.at.squaredNorm(), near_b = b.at.squaredNorm();
    return near_a != near_b ? near_a < near_b : a.index < b.index;
  });
  chain_.push_back(last);
  chain_.back().turned = width;

  keep_delaunay_neighbors();
  for (std::size_t k = 0; k + 1 < chain_.size(); ++k) {
    if (chain_[k + 1].turned - chain_[k].turned <= max_angle_)
      add_triangle(p, chain_[k], chain_[k + 1]);
  }
}

/// Complete the fan of a point as far as possible.
void Growth::complete(std::uint32_t p) {
  if (fans_.is_closed(p)) return;
  plane_ = tangent_plane(p);
  gather(p);
  find_borders();
  if (fans_.is_empty(p)) {
    // The nearest neighbor is a neighbor in any Delaunay triangulation.
    if (is_covered()) return;
    const Neighbor* nearest = nullptr;
    for (const Neighbor& q : neighbors_) {
      const auto rank = [](const Neighbor& v) { return std::pair(v.at.squaredNorm(), v.index); };
      if ((nearest == nullptr || rank(q) < rank(*nearest)) && is_in_reach(p, q.index) &&
          may_join(p, q))
        nearest = &q;
    }
    if (nearest != nullptr) close_gap(p, *nearest, *nearest, kFullTurn);
    return;
  }
  ends_.clear();
  starts_.clear();
  fans_.visit(p, [&](const Fans::Wedge& wedge) {
    if (!fans_.has_edge(p, wedge.to)) starts_.push_back(project(wedge.to));
    if (!fans_.has_edge(wedge.from, p)) ends_.push_back(project(wedge.from));
  });
  for (const Neighbor& first : starts_) {
    const auto width = [&](const Neighbor& end) { return turn(first.angle(), end.angle()); };
    const Neighbor& last = *std::ranges::min_element(ends_, {}, width);
    close_gap(p, first, last, width(last));
  }
}

Triangles Growth::grow() {
  is_reached_.assign(points_.size(), 0);
  for (std::uint32_t seed = 0; seed < points_.size(); ++seed) {
    if (spacings_[seed] > 0 && fans_.is_empty(seed)) {
      complete(seed);
      if (!fans_.is_empty(seed)) is_reached_[seed] = 1;
    }
    while (num_completed_ < front_.size()) complete(front_[num_completed_++]);
  }
  return std::move(triangles_);
}

}  // namespace

Result<Triangles> triangulate_greedy(PointsView points, NormalsView normals,
                                     const GreedyOptions& options) {
  TRIVET_REQUIRE(points.size() == normals.size(), "one normal a point");
  Growth growth(points, normals, options);
  TRIVET_TRY(growth.measure());
  return growth.grow();
}

}  // namespace trivet::kernels
