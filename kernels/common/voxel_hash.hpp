/// A voxel grid for neighbor searches with a known radius.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/common/voxels.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Points sorted by voxel, with a hash table that finds a row of voxels (equal y and z) at once.
///
/// Immutable once built: queries allocate nothing and are thread-safe.
/// Neighbors come in a fixed order: by voxel (z, then y, then x), then by index.
/// Distances are computed from float coordinates, dx*dx + dy*dy + dz*dz; the radius is included.
/// Source: cell lists (Allen and Tildesley, Computer Simulation of Liquids), sorted, not linked.
class VoxelHash {
 public:
  struct Nearest {
    std::uint32_t index;
    float squared_distance;
  };

  VoxelHash() : VoxelHash(PointsView{}, 1) {}

  /// Sort points into voxels of edge `cell`; fastest if that is about the radius of the queries.
  ///
  /// points  n < 2^32 positions, anywhere; those with a non-finite coordinate are never found
  /// cell    > 0; doubled until the number of voxels in the cloud's bounding box fits 64 bits
  /// Cost: O(n). Keeps a copy of the points.
  VoxelHash(PointsView points, float cell);

  /// Number of finite points.
  std::size_t size() const noexcept { return indices_.size(); }

  /// Call visit(index, squared_distance) for each point within radius of a query. A negative radius
  /// or a non-finite query finds nothing.
  template <class Visit>
  void visit_within(const Eigen::Vector3f& query, float radius, Visit&& visit) const {
    const PointsView sorted = sorted_;
    const float limit = radius * radius;
    visit_runs(query, radius, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const float d2 = squared_distance(sorted, i, query);
        if (d2 <= limit) visit(indices_[i], d2);
      }
    });
  }

  /// Call visit(points, indices) for runs of points that include all points within radius of a
  /// query, and others: indices[i] is the input index of points[i].
  template <class Visit>
  void visit_runs_within(const Eigen::Vector3f& query, float radius, Visit&& visit) const {
    const PointsView sorted = sorted_;
    visit_runs(query, radius, [&](std::size_t first, std::size_t last) {
      visit(sorted.slice(first, last - first), indices_.data() + first);
    });
  }

  /// Input indices of the points in sorted order. The runs of visit_runs_within are parts of it.
  std::span<const std::uint32_t> order() const noexcept { return indices_; }
  PointsView ordered_points() const noexcept { return sorted_; }

  /// Number of points within radius of a query.
  std::uint32_t count_within(const Eigen::Vector3f& query, float radius) const noexcept;

  /// The nearest point within max_radius, which may be infinite; ties go to the lowest index.
  std::optional<Nearest> nearest(const Eigen::Vector3f& query, float max_radius) const noexcept;

 private:
  static constexpr std::uint64_t kNoRow = 0xFFFFFFFFFFFFFFFF;

  struct Row {                          // row of voxels with equal y and z
    std::uint64_t key = kNoRow;         // y + counts[1] * z
    std::uint32_t first = 0, last = 0;  // its voxels, ascending in x
  };

  // A query in the lattice's frame: lengths in voxels, relative to the lowest voxel.
  struct Ball {
    double x, y, z, radius;                 // the radius is padded against rounding errors
    std::array<std::int64_t, 3> low, high;  // range of occupied voxels that the ball may touch

    double squared_gap(std::int64_t row_y, std::int64_t row_z) const noexcept {
      const double gap_y =
          std::max({0.0, static_cast<double>(row_y) - y, y - static_cast<double>(row_y + 1)});
      const double gap_z =
          std::max({0.0, static_cast<double>(row_z) - z, z - static_cast<double>(row_z + 1)});
      return gap_y * gap_y + gap_z * gap_z;
    }
  };

  static float squared_distance(PointsView sorted, std::size_t i,
                                const Eigen::Vector3f& query) noexcept {
    const float dx = sorted.x[i] - query.x(), dy = sorted.y[i] - query.y(),
                dz = sorted.z[i] - query.z();
    return dx * dx + dy * dy + dz * dz;
  }

  double padded_radius(const Eigen::Vector3f& query, double radius) const noexcept {
    return (radius * (1 + 1e-6) + 1e-14 * query.cast<double>().lpNorm<1>()) * lattice_.inverse_cell;
  }

  // Empty if the ball lies outside the occupied box, or is not finite.
  std::optional<Ball> ball(const Eigen::Vector3f& query, float radius) const noexcept;

  std::uint64_t slot(std::uint64_t key) const noexcept {
    return (key * 0x9E3779B97F4A7C15U) >> table_shift_;  // multiplicative hashing, 2^64 / phi
  }

  const Row* find_row(std::int64_t y, std::int64_t z) const noexcept {
    const std::uint64_t key =
        static_cast<std::uint64_t>(y) + rows_in_layer_ * static_cast<std::uint64_t>(z);
    std::uint64_t s = slot(key);
    while (table_[s].key != key && table_[s].key != kNoRow) s = (s + 1) & (table_.size() - 1);
    return table_[s].key == key ? &table_[s] : nullptr;
  }
  std::int64_t row_y(const Row& row) const noexcept {
    return static_cast<std::int64_t>(row.key % rows_in_layer_);
  }
  std::int64_t row_z(const Row& row) const noexcept {
    return static_cast<std::int64_t>(row.key / rows_in_layer_);
  }

  // Call consider(first, last) for the points of a row's voxels that touch a ball of this radius.
  template <class Consider>
  void consider_row(const Row& row, const Ball& b, double radius, std::int64_t y, std::int64_t z,
                    Consider&& consider) const {
    const double left = radius * radius - b.squared_gap(y, z);
    if (!(left >= 0)) return;
    const double half = std::sqrt(left), last_x = lattice_.counts[0] - 1;
    if (b.x + half < 0 || b.x - half > last_x + 1) return;
    const auto low = static_cast<std::uint32_t>(std::clamp(b.x - half, 0.0, last_x));
    const auto high = static_cast<std::uint32_t>(std::clamp(b.x + half, 0.0, last_x));
    const std::uint32_t* const voxels = voxel_x_.data();
    const std::uint32_t* const end = voxels + row.last;
    const std::uint32_t* const from = std::lower_bound(voxels + row.first, end, low);
    const std::uint32_t* to = from;
    while (to != end && *to <= high) ++to;
    if (from != to)
      consider(voxel_offsets_[static_cast<std::size_t>(from - voxels)],
               voxel_offsets_[static_cast<std::size_t>(to - voxels)]);
  }

  // Call consider(first, last) for runs of sorted points that include all points within radius.
  template <class Consider>
  void visit_runs(const Eigen::Vector3f& query, float radius, Consider&& consider) const {
    const std::optional<Ball> b = ball(query, radius);
    if (!b) return;

    // A ball that is large relative to the voxels touches more rows than exist.
    const double num_touched = static_cast<double>(b->high[1] - b->low[1] + 1) *
                               static_cast<double>(b->high[2] - b->low[2] + 1);
    if (num_touched > static_cast<double>(rows_.size())) {
      for (const Row& row : rows_) {
        consider_row(row, *b, b->radius, row_y(row), row_z(row), consider);
      }
      return;
    }
    for (std::int64_t z = b->low[2]; z <= b->high[2]; ++z) {
      for (std::int64_t y = b->low[1]; y <= b->high[1]; ++y) {
        const Row* row = find_row(y, z);
        if (row != nullptr) consider_row(*row, *b, b->radius, y, z, consider);
      }
    }
  }

  friend void fill_radius_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                                    std::span<const std::uint32_t> offsets,
                                    std::span<std::uint32_t> indices);

  VoxelLattice lattice_;
  std::uint64_t rows_in_layer_ = 1;  // counts[1]
  Points sorted_;
  Column<std::uint32_t> indices_;        // input index of each sorted point
  Column<std::uint32_t> voxel_x_;        // x of each voxel, in the order of the points
  Column<std::uint32_t> voxel_offsets_;  // first sorted point of each voxel (+ 1)
  Column<Row> rows_;                     // ascending by key
  Column<Row> table_;  // hash table of the rows: open addressing, at most half full
  int table_shift_ = 63;
};

/// Count the neighbors of each query.
///
/// queries  m positions
/// radius   unit of the points, included; a query that is itself a point counts as its own neighbor
/// out      m counts
/// No allocation or lock. Rows are independent: any split into chunks gives the same bits.
void count_radius_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                            std::span<std::uint32_t> out);

/// Write the neighbors of each query, in the order of VoxelHash.
///
/// offsets  m + 1, the exclusive sums of the counts (see Neighborhoods); offsets[0] need not be 0
/// indices  the whole column: row i goes to indices[offsets[i] .. offsets[i + 1])
/// Pre: same queries and radius as for the counts.
/// No allocation or lock. Rows are independent: any split into chunks gives the same bits.
void fill_radius_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                           std::span<const std::uint32_t> offsets,
                           std::span<std::uint32_t> indices);

}  // namespace trivet::kernels
