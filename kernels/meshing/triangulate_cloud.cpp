#include "kernels/meshing/triangulate_cloud.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <unordered_map>
#include <vector>

#include "kernels/common/nearest_neighbors.hpp"
#include "kernels/meshing/delaunay.hpp"
#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Corners = std::array<std::uint32_t, 3>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kSpacingNeighbors = 8;
// Smallest excess of the outside on one side of a point over the other; 1: half a ball.
constexpr double kMinOutward = 0.25;

double cosine_of_deg(float angle) { return std::cos(angle * std::numbers::pi / 180); }

std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

/// A face of a tetrahedron: the one opposite a corner.
struct Facet {
  std::uint32_t tetrahedron = Tetrahedron::kNone, corner = 0;
};

/// A face by which the surface may grow at a boundary edge.
struct Candidate {
  double grade;     // the highest first: 1 / radius for flat ones, minus the fold for others
  Corners corners;  // in winding order; the edge is corners[1] -> corners[0] of this triangle
  Facet facet;

  bool operator<(const Candidate& other) const {
    return grade != other.grade ? grade < other.grade : corners > other.corners;
  }
};

/// Positions with their local spacing, and the faces of their tetrahedra.
class Faces {
 public:
  Faces(const Delaunay& delaunay, float max_radius)
      : tetrahedra_(delaunay.tetrahedra), max_radius_(max_radius) {}

  /// Errors: no_memory.
  Result<void> measure(PointsView points, const Delaunay& delaunay);

  std::size_t num_places() const { return spacings_.size(); }
  bool is_place(std::uint32_t v) const { return v < spacings_.size(); }
  const Vector3d& position(std::uint32_t v) const { return positions_[v]; }
  const Column<Tetrahedron>& tetrahedra() const { return tetrahedra_; }
  /// The longest edge that a face of the surface may have between two positions.
  double max_edge(std::uint32_t u, std::uint32_t v) const {
    return 2 * max_radius_ * std::max(spacings_[u], spacings_[v]);
  }

  /// Corners of a face, counter-clockwise seen from outside the tetrahedron.
  Corners corners(const Facet& facet) const {
    const auto& c = tetrahedra_[facet.tetrahedron].corner;
    const std::size_t k = facet.corner;
    return k % 2 == 0 ? Corners{c[(k + 1) % 4], c[(k + 2) % 4], c[(k + 3) % 4]}
                      : Corners{c[(k + 1) % 4], c[(k + 3) % 4], c[(k + 2) % 4]};
  }
  double empty_radius(const Corners& c, const Facet& facet) const;

 private:
  std::uint32_t apex_of(std::uint32_t tetrahedron, std::uint32_t from) const {
    const Tetrahedron& t = tetrahedra_[tetrahedron];
    return t.corner[static_cast<std::size_t>(std::ranges::find(t.across, from) - t.across.begin())];
  }

  const Column<Tetrahedron>& tetrahedra_;
  double max_radius_;
  std::vector<Vector3d> positions_;  // positions, and the four far corners
  std::vector<double> spacings_;
};

Result<void> Faces::measure(PointsView points, const Delaunay& delaunay) {
  const std::size_t n = delaunay.places.size();
  Points places(n);
  for (std::size_t i = 0; i < n; ++i) {
    places.set(i, points[delaunay.places[i]]);
    positions_.push_back(places[i].cast<double>());
  }
  positions_.insert(positions_.end(), delaunay.far_corners.begin(), delaunay.far_corners.end());

  // The spacing is the square root of the area per point, from the nearest neighbors.
  const std::size_t k = std::min(kSpacingNeighbors + 1, n);
  TRIVET_TRY_ASSIGN(const NearestNeighbors tree, NearestNeighbors::build(places));
  std::vector<std::uint32_t> near(k * n);
  std::vector<float> squared(k * n);
  TRIVET_TRY(tree.k_nearest(places, k, near, squared));
  for (std::size_t i = 0; i < n; ++i) {
    spacings_.push_back(std::sqrt(static_cast<double>(squared[k * i + k - 1]) * std::numbers::pi /
                                  static_cast<double>(k - 1)));
  }
  return {};
}

/// The smallest radius of an empty ball through three corners; infinite if it is too large for the
/// local spacing.
double Faces::empty_radius(const Corners& c, const Facet& facet) const {
  if (!is_place(c[0]) || !is_place(c[1]) || !is_place(c[2])) return kInfinity;
  const Vector3d &a = positions_[c[0]], ab = positions_[c[1]] - a, ac = positions_[c[2]] - a;
  const Vector3d n = ab.cross(ac);
  const double n2 = n.squaredNorm();
  if (!(n2 > 0)) return kInfinity;
  const Vector3d center =
      (ac.squaredNorm() * n.cross(ab) + ab.squaredNorm() * ac.cross(n)) / (2 * n2);
  // Centers of balls through the corners lie at center + s n; those between the centers of both
  // tetrahedra are empty.
  double low = -kInfinity, high = kInfinity;
  const std::uint32_t other = tetrahedra_[facet.tetrahedron].across[facet.corner];
  for (const std::uint32_t apex :
       {tetrahedra_[facet.tetrahedron].corner[facet.corner], apex_of(other, facet.tetrahedron)}) {
    if (!is_place(apex)) continue;
    const Vector3d d = positions_[apex] - a;
    const double side = n.dot(d);
    const double s = (d.squaredNorm() - 2 * d.dot(center)) / (2 * side);
    if (side > 0) high = std::min(high, s);
    if (side < 0) low = std::max(low, s);
  }
  const double s = low > 0 ? low : high < 0 ? high : 0;
  const double radius = std::sqrt(center.squaredNorm() + s * s * n2);
  const double spacing = std::max({spacings_[c[0]], spacings_[c[1]], spacings_[c[2]]});
  return radius <= max_radius_ * spacing ? radius : kInfinity;
}

/// Mark the tetrahedra that a ball can reach from far away through faces that are large enough.
std::vector<std::uint8_t> find_outside(const Faces& faces) {
  const Column<Tetrahedron>& tetrahedra = faces.tetrahedra();
  std::vector<std::uint8_t> is_outside(tetrahedra.size(), 0);
  std::vector<std::uint32_t> reached;
  for (std::uint32_t t = 0; t < tetrahedra.size(); ++t) {
    if (std::ranges::all_of(tetrahedra[t].corner, [&](auto v) { return faces.is_place(v); }))
      continue;
    is_outside[t] = 1;
    reached.push_back(t);
  }
  while (!reached.empty()) {
    const std::uint32_t t = reached.back();
    reached.pop_back();
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t next = tetrahedra[t].across[k];
      if (next == Tetrahedron::kNone || is_outside[next] != 0) continue;
      if (faces.empty_radius(faces.corners({t, k}), {t, k}) < kInfinity) continue;
      is_outside[next] = 1;
      reached.push_back(next);
    }
  }
  return is_outside;
}

/// The integral of all directions over the solid angle between three unit vectors; by Stokes'
/// theorem half the sum of its sides' angles times their normals.
Vector3d sum_of_directions(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const auto side = [](const Vector3d& u, const Vector3d& v) -> Vector3d {
    const Vector3d normal = u.cross(v);
    const double sine = normal.norm();
    return sine > 0 ? Vector3d(std::atan2(sine, u.dot(v)) / sine * normal) : Vector3d::Zero();
  };
  const double turn = a.dot(b.cross(c)) > 0 ? 0.5 : -0.5;
  return turn * (side(a, b) + side(b, c) + side(c, a));
}

/// A surface that grows by faces of the Delaunay tetrahedra. Vertices are positions of the latter.
class Front {
 public:
  Front(const Faces& faces, std::vector<Vector3d> normals, const TriangulateOptions& options)
      : faces_(faces),
        tetrahedra_(faces.tetrahedra()),
        normals_(std::move(normals)),
        min_flat_(cosine_of_deg(options.flat_angle_deg)),
        min_fold_(cosine_of_deg(options.max_fold_angle_deg)),
        min_normal_(cosine_of_deg(options.max_normal_angle_deg)),
        max_hole_edges_(options.max_hole_edges),
        num_uses_(faces.num_places(), 0),
        num_open_(faces.num_places(), 0) {}

  void grow() {
    for (const Candidate& seed : find_seeds()) {
      const Corners& c = seed.corners;
      if (num_uses_[c[0]] + num_uses_[c[1]] + num_uses_[c[2]] > 0) continue;
      add(c, seed.facet);
      advance();
    }
    // If normals are wrong, as at edges, the shape decides.
    min_normal_ = -1;
    const std::size_t num_grown = triangles_.size();
    for (std::size_t t = 0; t < num_grown; ++t) propose_all(triangles_[t]);
    advance();
    fill_holes();
  }

  const std::vector<Corners>& triangles() const { return triangles_; }

 private:
  void fill_holes();

  /// Add the best candidates until no boundary edge has one.
  void advance() {
    while (!queue_.empty()) {
      const Candidate best = queue_.top();
      queue_.pop();
      const auto [from, to] = std::pair(best.corners[1], best.corners[0]);
      if (edges_.contains(edge_key(to, from))) continue;  // closed meanwhile
      if (may_add(best.corners))
        add(best.corners, best.facet);
      else
        propose(from, to);
    }
  }

  void propose_all(const Corners& c) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (!edges_.contains(edge_key(c[(k + 1) % 3], c[k]))) propose(c[k], c[(k + 1) % 3]);
    }
  }

  struct Edge {
    std::uint32_t triangle;
    Facet facet;
  };

  /// Cosines between a triangle and the normals of its corners; 1 for unknown ones.
  std::array<double, 3> normal_cosines(const Corners& c) const {
    const Vector3d n = (place(c[1]) - place(c[0])).cross(place(c[2]) - place(c[0])).normalized();
    std::array<double, 3> cosines;
    for (std::size_t k = 0; k < 3; ++k) {
      const double cosine = n.dot(normals_[c[k]]);
      cosines[k] = std::isnan(cosine) ? 1 : cosine;
    }
    return cosines;
  }

  /// Whether every corner's normal is within this angle of the triangle's.
  bool agrees(const Corners& c, double min_cosine) const {
    return std::ranges::min(normal_cosines(c)) >= min_cosine;
  }

  /// Whether normals allow a triangle: it must not be the back of the surface at all its corners.
  bool fits(const Corners& c) const {
    const auto [least, greatest] = std::ranges::minmax(normal_cosines(c));
    return least >= min_normal_ && greatest >= 0;
  }

  /// Seed triangles, the smallest first: those in best agreement with their normals.
  std::vector<Candidate> find_seeds() const {
    std::vector<Candidate> seeds;
    for (std::uint32_t t = 0; t < tetrahedra_.size(); ++t) {
      for (std::uint32_t k = 0; k < 4; ++k) {
        if (tetrahedra_[t].across[k] == Tetrahedron::kNone || tetrahedra_[t].across[k] < t)
          continue;
        Corners c = faces_.corners({t, k});
        if (!std::ranges::all_of(c, [&](auto v) { return faces_.is_place(v); })) continue;
        if (!agrees(c, min_flat_)) std::swap(c[1], c[2]);
        if (!agrees(c, min_flat_)) continue;
        const double radius = faces_.empty_radius(c, {t, k});
        if (radius < kInfinity) seeds.push_back({1 / radius, c, {t, k}});
      }
    }
    std::sort(seeds.begin(), seeds.end(),
              [](const Candidate& a, const Candidate& b) { return b < a; });
    return seeds;
  }

  /// Whether a triangle keeps every edge in at most two triangles, of one winding, and does not
  /// touch a vertex that is already surrounded.
  bool may_add(const Corners& c) const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (num_uses_[c[k]] > 0 && num_open_[c[k]] == 0) return false;
      if (edges_.contains(edge_key(c[k], c[(k + 1) % 3]))) return false;
    }
    return true;
  }

  /// Cosine of the fold angle of a triangle at the edge from -> to of the surface.
  double fold_cosine(std::uint32_t from, std::uint32_t to, std::uint32_t apex) const {
    const auto across = [&](std::uint32_t v) {
      const Vector3d e = (place(to) - place(from)).normalized(), d = place(v) - place(from);
      return (d - e.dot(d) * e).normalized();
    };
    const Corners& c = triangles_[edges_.find(edge_key(from, to))->second.triangle];
    return -across(c[0] + c[1] + c[2] - from - to).dot(across(apex));
  }

  /// Add a candidate: the best face at the boundary edge from -> to.
  void propose(std::uint32_t from, std::uint32_t to) {
    const Facet start = edges_.find(edge_key(from, to))->second.facet;
    if (start.tetrahedron == Tetrahedron::kNone) return;  // the edge may be in no tetrahedron
    Candidate best{-kInfinity, {}, {}};
    double best_radius = kInfinity;
    // Rotate about the edge through all tetrahedra. The surface's own face comes last.
    std::uint32_t at = start.tetrahedron, crossed = start.corner;
    do {
      // Leave by the other face at the edge.
      const Tetrahedron& t = tetrahedra_[at];
      std::size_t leave = 0;
      while (leave == crossed || t.corner[leave] == from || t.corner[leave] == to) ++leave;
      const std::uint32_t apex = t.corner[crossed];
      const std::uint32_t next = t.across[leave];
      if (faces_.is_place(apex)) {
        const Corners c{to, from, apex};
        const Facet facet{at, static_cast<std::uint32_t>(leave)};
        const double fold = may_add(c) ? worst_fold(c) : -1;
        const double radius =
            fold > min_fold_ && fits(c) ? faces_.empty_radius(c, facet) : kInfinity;
        if (radius < best_radius) {
          best_radius = radius;
          best = {fold > min_flat_ ? 1 / radius : fold - 2, c, facet};
        }
      }
      const auto& back = tetrahedra_[next].across;
      crossed = static_cast<std::uint32_t>(std::ranges::find(back, at) - back.begin());
      at = next;
    } while (at != start.tetrahedron);
    if (best_radius < kInfinity) queue_.push(best);
  }

  double worst_fold(const Corners& c) const {
    double worst = 1;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = c[(k + 1) % 3], to = c[k];
      if (edges_.contains(edge_key(from, to)))
        worst = std::min(worst, fold_cosine(from, to, c[(k + 2) % 3]));
    }
    return worst;
  }

  void add(const Corners& c, const Facet& facet) {
    const auto index = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(c);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = c[k], to = c[(k + 1) % 3];
      ++num_uses_[from];
      edges_.emplace(edge_key(from, to), Edge{index, facet});
      const bool closed = edges_.contains(edge_key(to, from));
      for (const std::uint32_t v : {from, to}) num_open_[v] += closed ? -1 : 1;
    }
    propose_all(c);
  }

  std::uint32_t before(std::uint32_t from, std::uint32_t to) const;
  void fill_from(std::uint32_t from, std::uint32_t to);
  void fill(const std::vector<std::uint32_t>& hole);

  const Vector3d& place(std::uint32_t v) const { return faces_.position(v); }

  const Faces& faces_;
  const Column<Tetrahedron>& tetrahedra_;
  std::vector<Vector3d> normals_;
  double min_flat_, min_fold_, min_normal_;
  std::size_t max_hole_edges_;
  std::vector<std::int32_t> num_uses_, num_open_;  // per position: triangles, boundary edges
  std::vector<Corners> triangles_;
  std::unordered_map<std::uint64_t, Edge> edges_;  // from -> to, in winding order
  std::priority_queue<Candidate> queue_;
};

/// The boundary edge that ends where this one starts, in the same fan of triangles.
std::uint32_t Front::before(std::uint32_t from, std::uint32_t to) const {
  std::uint32_t turned = to;
  for (;;) {
    const auto edge = edges_.find(edge_key(from, turned));
    if (edge == edges_.end()) return turned;
    const Corners& c = triangles_[edge->second.triangle];
    turned = c[0] + c[1] + c[2] - from - turned;
  }
}

/// Fill the hole beyond the boundary edge from -> to, if it is small. A boundary that touches
/// itself is cut into loops that do not.
void Front::fill_from(std::uint32_t from, std::uint32_t to) {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::uint32_t> loop;
  const std::uint32_t first_from = from, first_to = to;
  do {
    const auto again = std::ranges::find(loop, to);
    if (again != loop.end()) {
      loops.emplace_back(again, loop.end());
      loop.erase(again, loop.end());
    }
    if (loop.size() == max_hole_edges_) return;
    loop.push_back(to);
    const std::uint32_t next = before(from, to);
    to = from;
    from = next;
  } while (from != first_from || to != first_to);
  loops.push_back(std::move(loop));
  for (const auto& hole : loops) fill(hole);
}

/// Fill a hole with the triangulation of least area (dynamic programming over its segments).
void Front::fill(const std::vector<std::uint32_t>& hole) {
  const std::size_t n = hole.size();
  if (n < 3) return;
  std::vector<double> cost(n * n, 0);
  std::vector<std::size_t> middle(n * n, 0);
  const auto has_edge = [&](std::size_t i, std::size_t j) {
    return edges_.contains(edge_key(hole[i], hole[j])) ||
           edges_.contains(edge_key(hole[j], hole[i]));
  };
  for (std::size_t length = 2; length < n; ++length) {
    for (std::size_t i = 0; i + length < n; ++i) {
      const std::size_t j = i + length;
      double& least = cost[i * n + j];
      least = kInfinity;
      const bool is_diagonal = length + 1 < n;
      if (is_diagonal && (has_edge(i, j) || (place(hole[i]) - place(hole[j])).norm() >
                                                faces_.max_edge(hole[i], hole[j])))
        continue;
      for (std::size_t k = i + 1; k < j; ++k) {
        if (!fits({hole[i], hole[k], hole[j]})) continue;
        const Vector3d& a = place(hole[i]);
        const double area = (place(hole[k]) - a).cross(place(hole[j]) - a).norm() / 2;
        const double sum = cost[i * n + k] + cost[k * n + j] + area;
        if (sum < least) {
          least = sum;
          middle[i * n + j] = k;
        }
      }
    }
  }
  if (!(cost[n - 1] < kInfinity)) return;
  std::vector<std::pair<std::size_t, std::size_t>> stretches{{0, n - 1}};
  while (!stretches.empty()) {
    const auto [i, j] = stretches.back();
    stretches.pop_back();
    if (j - i < 2) continue;
    const std::size_t k = middle[i * n + j];
    add({hole[i], hole[k], hole[j]}, {});
    stretches.push_back({i, k});
    stretches.push_back({k, j});
  }
}

void Front::fill_holes() {
  const std::size_t num_grown = triangles_.size();
  for (std::size_t t = 0; t < num_grown; ++t) {
    const Corners c = triangles_[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t from = c[k], to = c[(k + 1) % 3];
      if (!edges_.contains(edge_key(to, from))) fill_from(from, to);
    }
  }
}

}  // namespace

Result<void> orient_by_empty_space(PointsView points, const Delaunay& delaunay, float max_radius,
                                   NormalsSpan normals) {
  TRIVET_REQUIRE(normals.size() == points.size(), "one normal a point");
  const std::size_t n = delaunay.places.size();
  if (n < 3) return {};
  Faces faces(delaunay, max_radius);
  TRIVET_TRY(faces.measure(points, delaunay));

  // Sum of all outward directions: pi times the normal if they are a half space.
  const std::vector<std::uint8_t> is_outside = find_outside(faces);
  std::vector<Vector3d> outward(n, Vector3d::Zero());
  for (std::size_t t = 0; t < is_outside.size(); ++t) {
    if (is_outside[t] == 0) continue;
    const auto& c = delaunay.tetrahedra[t].corner;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!faces.is_place(c[k])) continue;
      std::array<Vector3d, 3> to;
      for (std::size_t i = 0; i < 3; ++i)
        to[i] = (faces.position(c[(k + i + 1) % 4]) - faces.position(c[k])).normalized();
      outward[c[k]] += sum_of_directions(to[0], to[1], to[2]);
    }
  }
  Column<float> signs(points.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3f normal = NormalsView(normals)[delaunay.places[i]];
    const double along = outward[i].dot(normal.cast<double>());
    if (std::abs(along) > kMinOutward * std::numbers::pi)
      signs[delaunay.places[i]] = along > 0 ? 1.0F : -1.0F;
  }
  for (std::size_t i = 0; i < points.size(); ++i)
    normals.set(i, signs[i] * NormalsView(normals)[i]);
  return {};
}

Result<Triangles> triangulate_cloud(PointsView points, const Delaunay& delaunay,
                                    NormalsView normals, const TriangulateOptions& options) {
  TRIVET_REQUIRE(normals.size() == points.size(), "one normal a point");
  Triangles triangles;
  if (delaunay.places.size() < 3) return triangles;
  Faces faces(delaunay, options.max_radius);
  TRIVET_TRY(faces.measure(points, delaunay));
  std::vector<Vector3d> directions;
  for (const std::uint32_t i : delaunay.places) directions.push_back(normals[i].cast<double>());
  Front front(faces, std::move(directions), options);
  front.grow();
  for (const Corners& c : front.triangles())
    triangles.push_back(delaunay.places[c[0]], delaunay.places[c[1]], delaunay.places[c[2]]);
  return triangles;
}

}  // namespace trivet::kernels
