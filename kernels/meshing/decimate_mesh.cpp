#include "kernels/meshing/decimate_mesh.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <vector>

namespace trivet::kernels {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::uint32_t kNoCorner = 0xFFFF'FFFFU;
// Limits: a triangle may rotate by up to 60 degrees, and become this thin (1: equilateral).
constexpr double kMinTurnCosine = 0.5;
constexpr double kMinQuality = 0.02;
// Relative weight of the constraint that keeps a vertex near the middle of its edge where the
// planes do not determine its position.
constexpr double kMiddleWeight = 1e-4;
// Relative weight of the squared length, added to the error: on planes, where the error is the same
// for all, short edges go first.
constexpr double kLengthWeight = 1e-8;

/// The sum of squared distances from weighted planes, as a function of the position.
struct Quadric {
  Matrix3d normals = Matrix3d::Zero();
  Vector3d offsets = Vector3d::Zero();
  double constant = 0;

  void add(const Vector3d& normal, const Vector3d& point, double weight) {
    const double offset = normal.dot(point);
    normals += weight * normal * normal.transpose();
    offsets += weight * offset * normal;
    constant += weight * offset * offset;
  }
  Quadric& operator+=(const Quadric& other) {
    normals += other.normals;
    offsets += other.offsets;
    constant += other.constant;
    return *this;
  }
  double operator()(const Vector3d& p) const {
    return std::max(0.0, p.dot(normals * p) - 2 * p.dot(offsets) + constant);
  }
  /// The position with the least sum; near `middle` where the planes do not determine it.
  Vector3d best(const Vector3d& middle) const {
    const double hold = kMiddleWeight * normals.trace();
    if (!(hold > 0)) return middle;
    const Matrix3d held = normals + hold * Matrix3d::Identity();
    return middle + held.inverse() * (offsets - normals * middle);
  }
};

struct Vertex {
  Vector3d place;
  Quadric quadric;
  std::uint32_t first_corner = kNoCorner,
                last_corner = kNoCorner;  // list of its triangles' corners
  std::uint32_t changes = 0;              // edges rated before the last change are out of date
  bool border = false, fixed = false, alive = true;
};

struct Collapse {
  double cost;
  std::uint32_t u, v, changes;

  bool operator<(const Collapse& other) const {  // the cheapest on top, then the lowest index
    if (cost != other.cost) return cost > other.cost;
    return u != other.u ? u > other.u : v > other.v;
  }
};

using Corners = std::array<std::uint32_t, 3>;

class Decimation {
 public:
  Decimation(PointsView vertices, const Triangles& triangles)
      : vertices_(vertices.size()), marks_(vertices.size(), 0) {
    if (vertices.empty()) return;
    origin_ = vertices[0].cast<double>();
    for (std::size_t i = 0; i < vertices.size(); ++i)
      vertices_[i].place = vertices[i].cast<double>() - origin_;
    triangles_.reserve(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Corners corners{triangles.a[t], triangles.b[t], triangles.c[t]};
      if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
        triangles_.push_back(corners);
    }
    num_triangles_ = triangles_.size();
    next_corner_.assign(3 * num_triangles_, kNoCorner);
    add_planes();
    for (std::uint32_t c = 0; c < next_corner_.size(); ++c) append(vertices_[vertex(c)], c, c);
    add_edges();
  }

  void run(std::size_t num_triangles, double max_error) {
    while (num_triangles_ > num_triangles && !queue_.empty()) {
      const Collapse next = queue_.top();
      queue_.pop();
      if (!is_current(next)) continue;
      Vertex &u = vertices_[next.u], &v = vertices_[next.v];
      Quadric sum = u.quadric;
      const Vector3d place = place_of(u, v, sum += v.quadric);
      if (sum(place) > max_error * max_error) continue;
      if (may_collapse(next.u, next.v, place)) collapse(next.u, next.v, place);
    }
  }

  Mesh result() const {
    std::vector<std::uint32_t> index(vertices_.size(), kNoCorner);
    for (const Corners& corners : triangles_) {
      if (!is_alive(corners)) continue;
      for (const std::uint32_t i : corners) index[i] = 0;
    }
    Mesh mesh;
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (index[i] == kNoCorner) continue;
      index[i] = static_cast<std::uint32_t>(mesh.vertices.size());
      mesh.vertices.push_back((vertices_[i].place + origin_).cast<float>());
    }
    for (const Corners& c : triangles_) {
      if (is_alive(c)) mesh.triangles.push_back(index[c[0]], index[c[1]], index[c[2]]);
    }
    return mesh;
  }

 private:
  static bool is_alive(const Corners& corners) { return corners[0] != kNoCorner; }
  static bool holds(const Corners& corners, std::uint32_t vertex) {
    return corners[0] == vertex || corners[1] == vertex || corners[2] == vertex;
  }
  std::uint32_t vertex(std::uint32_t corner) const { return triangles_[corner / 3][corner % 3]; }
  Vector3d area_vector(const Corners& c) const {
    const Vector3d& a = vertices_[c[0]].place;
    return (vertices_[c[1]].place - a).cross(vertices_[c[2]].place - a) / 2;
  }
  bool is_current(const Collapse& c) const {
    const Vertex &u = vertices_[c.u], &v = vertices_[c.v];
    return u.alive && v.alive && u.changes + v.changes == c.changes;
  }

  /// Call body(triangle's corners) for the triangles about a vertex.
  template <class Body>
  void for_triangles(const Vertex& v, Body&& body) {
    for (std::uint32_t c = v.first_corner; c != kNoCorner; c = next_corner_[c]) {
      if (is_alive(triangles_[c / 3])) body(triangles_[c / 3]);
    }
  }
  void append(Vertex& v, std::uint32_t first, std::uint32_t last) {
    if (first == kNoCorner) return;
    if (v.first_corner == kNoCorner) {
      v.first_corner = first;
    } else {
      next_corner_[v.last_corner] = first;
    }
    v.last_corner = last;
  }

  // Add each triangle's plane, weighted by area: the mean triangle has weight one.
  void add_planes() {
    double area = 0;
    for (const Corners& corners : triangles_) area += area_vector(corners).norm();
    mean_area_ = area / static_cast<double>(std::max<std::size_t>(1, triangles_.size()));
    if (!(mean_area_ > 0)) return;
    for (const Corners& corners : triangles_) {
      const Vector3d vector = area_vector(corners);
      const double size = vector.norm();
      if (!(size > 0)) continue;
      for (const std::uint32_t i : corners)
        vertices_[i].quadric.add(vector / size, vertices_[i].place, size / mean_area_);
    }
  }

  // Sort the edges: those of one triangle are a border, vertices of those of more than two stay.
  void add_edges() {
    struct Edge {
      std::uint32_t u, v, triangle;
    };
    std::vector<Edge> edges;
    edges.reserve(3 * triangles_.size());
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
        edges.push_back({std::min(a, b), std::max(a, b), t});
      }
    }
    std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
      if (a.u != b.u) return a.u < b.u;
      return a.v != b.v ? a.v < b.v : a.triangle < b.triangle;
    });
    const auto same = [&](std::size_t i, std::size_t j) {
      return edges[i].u == edges[j].u && edges[i].v == edges[j].v;
    };
    for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
      for (end = i; end < edges.size() && same(i, end);) ++end;
      Vertex &u = vertices_[edges[i].u], &v = vertices_[edges[i].v];
      if (end - i > 2) u.fixed = v.fixed = true;
      if (end - i == 1) add_border(triangles_[edges[i].triangle], u, v);
    }
    for (std::size_t i = 0; i < edges.size(); ++i) {
      if (i == 0 || !same(i - 1, i)) rate(edges[i].u, edges[i].v);
    }
  }

  // A plane through the edge, perpendicular to its triangle, preserves a border's shape.
  void add_border(const Corners& triangle, Vertex& u, Vertex& v) {
    u.border = v.border = true;
    const Vector3d along = v.place - u.place, across = along.cross(area_vector(triangle));
    if (!(across.norm() > 0)) return;
    for (Vertex* end : {&u, &v})
      end->quadric.add(across.normalized(), u.place, along.squaredNorm() / mean_area_);
  }

  static Vector3d place_of(const Vertex& u, const Vertex& v, const Quadric& sum) {
    const Vector3d middle = (u.place + v.place) / 2;
    Vector3d place = sum.best(middle);
    for (const Vector3d& other : {u.place, v.place}) {
      if (sum(other) < sum(place)) place = other;
    }
    return place;
  }

  void rate(std::uint32_t i, std::uint32_t j) {
    const Vertex &u = vertices_[i], &v = vertices_[j];
    if (u.fixed || v.fixed) return;
    Quadric sum = u.quadric;
    const Vector3d place = place_of(u, v, sum += v.quadric);
    const double cost = sum(place) + kLengthWeight * (u.place - v.place).squaredNorm();
    queue_.push({cost, std::min(i, j), std::max(i, j), u.changes + v.changes});
  }

  // Link condition: u and v may have no more common neighbors than triangles. A single triangle and
  // a tetrahedron satisfy it, but would vanish.
  bool may_collapse(std::uint32_t u, std::uint32_t v, const Vector3d& place) {
    std::uint32_t num_u = 0, num_v = 0, num_both = 0, num_common = 0;
    const std::uint32_t mark = ++last_mark_;
    for_triangles(vertices_[u], [&](const Corners& corners) {
      ++num_u;
      num_both += holds(corners, v);
      for (const std::uint32_t i : corners) marks_[i] = mark;
    });
    marks_[u] = marks_[v] = 0;
    for_triangles(vertices_[v], [&](const Corners& corners) {
      ++num_v;
      for (const std::uint32_t i : corners) {
        num_common += marks_[i] == mark;
        if (marks_[i] == mark) marks_[i] = 0;
      }
    });
    if (num_both == 0 || num_common != num_both) return false;
    if (num_both == 2 ? num_u == 3 && num_v == 3 : num_u == 1 && num_v == 1) return false;
    if (num_both != 1 && vertices_[u].border && vertices_[v].border) return false;
    return keeps_triangles(u, v, place) && keeps_triangles(v, u, place);
  }

  // Whether the triangles about u but not v neither flip nor become thin when u moves.
  bool keeps_triangles(std::uint32_t u, std::uint32_t v, const Vector3d& place) {
    bool keeps = true;
    for_triangles(vertices_[u], [&](const Corners& corners) {
      if (!keeps || holds(corners, v)) return;
      const std::size_t k = corners[0] == u ? 0 : corners[1] == u ? 1 : 2;
      const Vector3d& a = vertices_[corners[(k + 1) % 3]].place;
      const Vector3d& b = vertices_[corners[(k + 2) % 3]].place;
      const Vector3d before = area_vector(corners), after = (a - place).cross(b - place) / 2;
      const auto quality = [&](const Vector3d& apex, double area) {
        return 4 * std::sqrt(3.0) * area /
               ((a - apex).squaredNorm() + (b - apex).squaredNorm() + (a - b).squaredNorm());
      };
      const double size = after.norm(), old_size = before.norm();
      keeps = size > 0 && before.dot(after) >= kMinTurnCosine * size * old_size &&
              quality(place, size) >= std::min(kMinQuality, quality(vertices_[u].place, old_size));
    });
    return keeps;
  }

  void collapse(std::uint32_t i, std::uint32_t j, const Vector3d& place) {
    Vertex &u = vertices_[i], &v = vertices_[j];
    for (std::uint32_t c = v.first_corner; c != kNoCorner; c = next_corner_[c]) {
      Corners& corners = triangles_[c / 3];
      if (!is_alive(corners)) continue;
      if (holds(corners, i)) {
        corners[0] = kNoCorner;
        --num_triangles_;
      } else {
        corners[c % 3] = i;
      }
    }
    append(u, v.first_corner, v.last_corner);
    drop_dead_corners(u);
    u.place = place;
    u.quadric += v.quadric;
    u.border = u.border || v.border;
    ++u.changes;
    v.alive = false;

    const std::uint32_t mark = ++last_mark_;
    for_triangles(u, [&](const Corners& corners) {
      for (const std::uint32_t k : corners) {
        if (k == i || marks_[k] == mark) continue;
        marks_[k] = mark;
        rate(i, k);
      }
    });
  }

  void drop_dead_corners(Vertex& v) {
    const std::uint32_t first = v.first_corner;
    v.first_corner = v.last_corner = kNoCorner;
    for (std::uint32_t c = first, next; c != kNoCorner; c = next) {
      next = next_corner_[c];
      next_corner_[c] = kNoCorner;
      if (is_alive(triangles_[c / 3])) append(v, c, c);
    }
  }

  Vector3d origin_{0, 0, 0};
  double mean_area_ = 0;
  std::vector<Vertex> vertices_;
  std::vector<Corners> triangles_;          // first corner kNoCorner: removed
  std::vector<std::uint32_t> next_corner_;  // next corner of the same vertex; corner 3 t + k
  std::vector<std::uint32_t> marks_;        // per vertex: the last query that visited it
  std::uint32_t last_mark_ = 0;
  std::size_t num_triangles_ = 0;  // remaining triangles
  std::priority_queue<Collapse> queue_;
};

}  // namespace

Mesh decimate_mesh(PointsView vertices, const Triangles& triangles, std::size_t num_triangles,
                   float max_error) {
  Decimation decimation(vertices, triangles);
  decimation.run(num_triangles, static_cast<double>(max_error));
  return decimation.result();
}

}  // namespace trivet::kernels
