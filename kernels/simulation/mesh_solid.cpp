#include "kernels/simulation/mesh_solid.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Index3 = std::array<std::uint32_t, 3>;

constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
// Relative to squared normals: directions with weaker agreement of a cell's planes are no
// constraint.
constexpr double kMinConstraint = 0.02;
// Distance beyond its cell that a vertex may move to meet an edge whose tip no lattice edge
// crosses.
constexpr float kReach = 0.3F;

/// A lattice around a solid; nodes are numbered x first, then y, then z. Cells are identified by
/// their lowest node.
struct Lattice {
  Vector3f origin;
  float cell;
  Index3 counts;  ///< number of nodes
  std::array<std::size_t, 3> strides;

  // Two spare cells on all sides. The shift keeps faces at round coordinates off the nodes.
  Lattice(const Eigen::AlignedBox3f& bounds, float edge) : cell(edge) {
    const Vector3f shift(0.377F, 0.419F, 0.461F);
    origin = bounds.min() - edge * (2 * Vector3f::Ones() - shift);
    for (std::size_t k = 0; k < 3; ++k) {
      const float span = bounds.sizes()[static_cast<Eigen::Index>(k)] / edge;
      counts[k] = static_cast<std::uint32_t>(std::ceil(span)) + 5;
    }
    strides = {1, counts[0], std::size_t{counts[0]} * counts[1]};
  }
  std::size_t size() const { return strides[2] * counts[2]; }
  std::size_t index(const Index3& n) const { return n[0] + n[1] * strides[1] + n[2] * strides[2]; }
  Vector3f position(const Index3& n) const {
    return origin + cell * Vector3f(static_cast<float>(n[0]), static_cast<float>(n[1]),
                                    static_cast<float>(n[2]));
  }
  /// Call body(node, index) for the nodes from `low` to below `high`.
  template <class Body>
  void for_nodes(const Index3& low, const Index3& high, Body&& body) const {
    Index3 n;
    for (n[2] = low[2]; n[2] < high[2]; ++n[2]) {
      for (n[1] = low[1]; n[1] < high[1]; ++n[1]) {
        n[0] = low[0];
        for (std::size_t i = index(n); n[0] < high[0]; ++n[0], ++i) body(n, i);
      }
    }
  }
};

/// The solid in blocks of nodes, each restricted to the parts that matter there.
class Blocks {
 public:
  Blocks(const Lattice& lattice, const Solid& solid) : lattice_(lattice), values_(lattice.size()) {
    for (std::size_t k = 0; k < 3; ++k) counts_[k] = (lattice.counts[k] + kBlock - 1) / kBlock;
    near_of_block_.assign(std::size_t{counts_[0]} * counts_[1] * counts_[2], kNone);
    Solid near = solid;
    Index3 block;
    for (block[2] = 0; block[2] < counts_[2]; ++block[2]) {
      for (block[1] = 0; block[1] < counts_[1]; ++block[1]) {
        for (block[0] = 0; block[0] < counts_[0]; ++block[0]) fill(solid, block, near);
      }
    }
  }

  /// Value at a node; away from the surface only its sign is correct.
  float operator[](std::size_t i) const { return values_[i]; }
  bool inside(std::size_t i) const { return values_[i] < 0; }
  void put_inside(std::size_t i) { values_[i] = -std::numeric_limits<float>::min(); }

  /// The solid restricted to the neighborhood of a cell that the surface crosses.
  const Solid& near(const Index3& cell) const { return near_[near_of_block_[index(cell)]]; }

 private:
  static constexpr std::uint32_t kBlock = 4;  // nodes along a side of a block

  std::size_t index(const Index3& node) const {
    return node[0] / kBlock +
           counts_[0] * (node[1] / kBlock + std::size_t{counts_[1]} * (node[2] / kBlock));
  }

  // A ball about the block contains its cells, those below, and the range of their vertices.
  void fill(const Solid& solid, const Index3& block, Solid& near) {
    Index3 low, high;
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = kBlock * block[k];
      high[k] = std::min(low[k] + kBlock, lattice_.counts[k]);
    }
    const float half = lattice_.cell * (kBlock + 1) / 2;
    const Vector3f center = lattice_.position(low) + Vector3f::Constant(half - lattice_.cell);
    const float radius = std::sqrt(3.0F) * (half + kReach * lattice_.cell);
    const float distance = solid.restrict_to(center, radius, near);
    if (std::abs(distance) > radius) {
      lattice_.for_nodes(low, high, [&](const Index3&, std::size_t i) { values_[i] = distance; });
      return;
    }
    near_of_block_[index(low)] = static_cast<std::uint32_t>(near_.size());
    near_.push_back(near);
    lattice_.for_nodes(low, high, [&](const Index3& n, std::size_t i) {
      values_[i] = near.distance(lattice_.position(n));
    });
  }

  const Lattice& lattice_;
  std::vector<float> values_;
  Index3 counts_;  // number of blocks
  std::vector<std::uint32_t> near_of_block_;
  std::vector<Solid> near_;
};

/// Move outside nodes inside until the set is well-composed. Each pass tests every 2 x 2 x 2 nodes;
/// nodes only ever move inside, so it terminates.
void make_well_composed(const Lattice& lattice, Blocks& values) {
  const auto& s = lattice.strides;
  const Index3 end{lattice.counts[0] - 1, lattice.counts[1] - 1, lattice.counts[2] - 1};
  bool changed = true;
  while (changed) {
    changed = false;
    lattice.for_nodes({0, 0, 0}, end, [&](const Index3&, std::size_t i) {
      // The four nodes of a face: one diagonal inside, the other outside.
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t u = i + s[k], v = i + s[(k + 1) % 3], w = u + s[(k + 1) % 3];
        const bool here = values.inside(i);
        if (here != values.inside(w) || values.inside(u) != values.inside(v) ||
            here == values.inside(u))
          continue;
        values.put_inside(here ? (values[u] < values[v] ? u : v) : (values[i] < values[w] ? i : w));
        changed = true;
      }
      // The eight of a cell: two opposite ones alone inside, or alone outside.
      unsigned mask = 0;
      const auto node = [&](unsigned c) {
        return i + (c & 1U) * s[0] + (c >> 1U & 1U) * s[1] + (c >> 2U) * s[2];
      };
      for (unsigned c = 0; c < 8; ++c) mask |= static_cast<unsigned>(values.inside(node(c))) << c;
      for (unsigned c = 0; c < 4; ++c) {
        const unsigned pair = 1U << c | 1U << (7 - c);
        if (mask != pair && mask != (0xFFU & ~pair)) continue;
        values.put_inside(mask == pair ? node(c ^ 1U) : node(c));
        changed = true;
      }
    });
  }
}

/// The tangent planes for a cell's vertex, as sums about the lattice's origin.
struct Planes {
  Matrix3d normals = Matrix3d::Zero();    ///< sum of n n^T
  Vector3d offsets = Vector3d::Zero();    ///< sum of n (n . p)
  Vector3d crossings = Vector3d::Zero();  ///< sum of p
  double count = 0;

  void add(const Vector3f& normal, const Vector3f& point) {
    const Vector3d n = normal.cast<double>(), p = point.cast<double>();
    normals += n * n.transpose();
    offsets += n.dot(p) * n;
    crossings += p;
    count += 1;
  }
  /// The least-squares intersection of the planes that is nearest to the mean crossing.
  Vector3f meet() const {
    const Vector3d mean = crossings / count, left = offsets - normals * mean;
    Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
    solver.computeDirect(normals);
    Vector3d point = mean;
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = solver.eigenvectors().col(k);
      if (solver.eigenvalues()[k] > kMinConstraint * count)
        point += axis.dot(left) / solver.eigenvalues()[k] * axis;
    }
    return point.cast<float>();
  }
};

/// A lattice edge from a node towards +axis that crosses the surface.
struct Crossing {
  Index3 node;
  std::uint32_t axis;
};

/// A vertex for each cell that the surface crosses.
class CellVertices {
 public:
  CellVertices(const Lattice& lattice, const Blocks& values)
      : lattice_(lattice), values_(values), vertex_of_cell_(lattice.size(), kNone) {
    lattice.for_nodes({1, 1, 1}, end(), [&](const Index3& n, std::size_t i) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        const std::size_t next = i + lattice.strides[axis];
        if (values.inside(i) == values.inside(next)) continue;
        crossings_.push_back({n, axis});
        add(crossings_.back(), values[i] / (values[i] - values[next]));
      }
    });
  }

  const std::vector<Crossing>& crossings() const { return crossings_; }

  /// The cells about a crossed edge, in right-handed order about its axis.
  std::array<std::size_t, 4> cells(const Crossing& c) const {
    const std::size_t i = lattice_.index(c.node), u = lattice_.strides[(c.axis + 1) % 3],
                      v = lattice_.strides[(c.axis + 2) % 3];
    return {i - u - v, i - v, i, i - u};
  }
  std::uint32_t vertex(std::size_t cell) const { return vertex_of_cell_[cell]; }

  Points place() const {
    Points points(planes_.size());
    const Vector3f half = Vector3f::Constant(lattice_.cell / 2);
    for (std::size_t i = 0; i < planes_.size(); ++i) {
      const Vector3f center = lattice_.position(cells_[i]) + half;
      const auto limit = [&](const Vector3f& p) -> Vector3f {
        const Vector3f reach = (1 + 2 * kReach) * half;
        return p.cwiseMax(center - reach).cwiseMin(center + reach);
      };
      // Tangent planes of curved faces meet beside the surface: move one step towards it.
      const Vector3f met = limit(planes_[i].meet());
      const SolidSample there = values_.near(cells_[i]).sample(met);
      points.set(i, limit(met - there.distance * there.gradient));
    }
    return points;
  }

 private:
  Index3 end() const {
    return {lattice_.counts[0] - 1, lattice_.counts[1] - 1, lattice_.counts[2] - 1};
  }

  void add(const Crossing& crossing, float share) {
    Vector3f point = lattice_.position(crossing.node);
    point[crossing.axis] += share * lattice_.cell;
    const SolidSample there = values_.near(crossing.node).sample(point);
    const Vector3f normal = there.gradient.stableNormalized();  // zero without a slope
    const float slope = std::max(there.gradient.norm(), 0.1F);  // blends are a little flatter
    const Vector3f foot = point - there.distance / slope * normal;
    const Index3& n = crossing.node;
    const std::uint32_t u = (crossing.axis + 1) % 3, v = (crossing.axis + 2) % 3;
    for (const auto& [du, dv] : {std::array{1U, 1U}, {0U, 1U}, {0U, 0U}, {1U, 0U}}) {
      Index3 cell = n;
      cell[u] -= du;
      cell[v] -= dv;
      std::uint32_t& vertex = vertex_of_cell_[lattice_.index(cell)];
      if (vertex == kNone) {
        vertex = static_cast<std::uint32_t>(planes_.size());
        planes_.emplace_back();
        cells_.push_back(cell);
      }
      planes_[vertex].add(normal, foot);
    }
  }

  const Lattice& lattice_;
  const Blocks& values_;
  std::vector<std::uint32_t> vertex_of_cell_;
  std::vector<Planes> planes_;  // one per vertex
  std::vector<Index3> cells_;   // one per vertex
  std::vector<Crossing> crossings_;
};

/// Add two triangles, split along the diagonal nearer to the surface: creases are preserved.
void add_quadrangle(const Solid& solid, const std::array<std::uint32_t, 4>& q, Mesh& mesh) {
  const auto error = [&](std::uint32_t i, std::uint32_t j) {
    return std::abs(solid.distance((mesh.vertices[i] + mesh.vertices[j]) / 2));
  };
  const std::size_t turn = error(q[0], q[2]) <= error(q[1], q[3]) ? 0 : 1;
  const auto corner = [&](std::size_t k) { return q[(k + turn) % 4]; };
  mesh.triangles.push_back(corner(0), corner(1), corner(2));
  mesh.triangles.push_back(corner(0), corner(2), corner(3));
}

}  // namespace

Mesh mesh_solid(const Solid& solid, float cell) {
  if (solid.bounds().isEmpty()) return {};
  TRIVET_REQUIRE(solid.bounds().sizes().allFinite(), "a lattice needs bounds");
  const Lattice lattice(solid.bounds(), cell);
  Blocks values(lattice, solid);
  make_well_composed(lattice, values);
  const CellVertices vertices(lattice, values);

  Mesh mesh{vertices.place(), {}};
  for (const Crossing& crossing : vertices.crossings()) {
    std::array<std::uint32_t, 4> corners;
    std::ranges::transform(vertices.cells(crossing), corners.begin(),
                           [&](std::size_t i) { return vertices.vertex(i); });
    // The surface faces along the axis where the axis leaves the solid.
    if (!values.inside(lattice.index(crossing.node))) std::ranges::reverse(corners);
    add_quadrangle(values.near(crossing.node), corners, mesh);
  }
  return mesh;
}

}  // namespace trivet::kernels
