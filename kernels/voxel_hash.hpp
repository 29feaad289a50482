/// A grid for neighbour searches of a known radius.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/voxels.hpp"
#include "storage/columns.hpp"
#include "storage/points.hpp"

namespace trivet::kernels {

/// Points sorted by voxel, with a table that finds a row of voxels (equal y and z) at once.
///
/// Built once, then only read: queries allocate nothing and may run side by side.
/// Neighbours come in a fixed order: by voxel (z, then y, then x), then by index.
/// Distances are those of float coordinates, dx*dx + dy*dy + dz*dz; a radius includes its sphere.
/// Source: cell lists (Allen and Tildesley, Computer Simulation of Liquids), sorted, not linked.
class VoxelHash {
 public:
  struct Nearest {
    std::uint32_t index;
    float squared_distance;
  };

  VoxelHash() : VoxelHash(PointsView{}, 1) {}

  /// Sort points into voxels of edge `cell`; fastest where that is about the radius of the queries.
  ///
  /// points  n < 2^32 positions, anywhere; those with a non-finite coordinate are never found
  /// cell    > 0; doubled until the voxels of the cloud's box can be counted in 64 bits
  /// Cost: O(n). Keeps a copy of the points.
  VoxelHash(PointsView points, float cell);

  /// Number of points that can be found.
  std::size_t size() const noexcept { return indices_.size(); }

  /// Call visit(index, squared_distance) for each point within radius of a query.
  /// Nothing lies within a negative radius, nor near a query that is not finite.
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

  /// Number of points within radius of a query.
  std::uint32_t count_within(const Eigen::Vector3f& query, float radius) const noexcept;

  /// The nearest point within max_radius, which may be infinite; of equally near ones the one of
  /// lowest index.
  std::optional<Nearest> nearest(const Eigen::Vector3f& query, float max_radius) const noexcept;

 private:
  static constexpr std::uint32_t kNoRow = 0xFFFFFFFF;

  struct Box {  // of voxels, both ends included
    std::array<std::int64_t, 3> low, high;
  };

  static float squared_distance(PointsView sorted, std::size_t i,
                                const Eigen::Vector3f& query) noexcept {
    const float dx = sorted.x[i] - query.x(), dy = sorted.y[i] - query.y(),
                dz = sorted.z[i] - query.z();
    return dx * dx + dy * dy + dz * dz;
  }

  // A radius that rounding, in the distances or in the lattice, cannot make too small.
  static double padded(const Eigen::Vector3f& query, double radius) noexcept {
    return radius * (1 + 1e-6) + 1e-14 * query.cast<double>().lpNorm<1>();
  }

  // The occupied box's voxels that a ball may touch; none if the ball lies outside it.
  std::optional<Box> touched_box(const Eigen::Vector3f& query, double radius) const noexcept;

  double squared_gap(const Eigen::Vector3f& query, std::int64_t y, std::int64_t z) const noexcept;
  std::int64_t row_y(std::uint32_t row) const noexcept;
  std::int64_t row_z(std::uint32_t row) const noexcept;
  std::uint64_t slot(std::uint64_t row_key) const noexcept {
    return (row_key * 0x9E3779B97F4A7C15U) >> table_shift_;  // multiplicative hashing, 2^64 / phi
  }
  std::uint32_t find_row(std::int64_t y, std::int64_t z) const noexcept;

  template <class Consider>
  void consider_row(std::uint32_t row, const Eigen::Vector3f& query, double half,
                    Consider&& consider) const {
    const auto first = voxel_x_.begin() + row_offsets_[row];
    const auto last = voxel_x_.begin() + row_offsets_[row + 1];
    const double low = lattice_.coordinate(query.x() - half, 0);
    const double high = lattice_.coordinate(query.x() + half, 0);
    const auto from = std::lower_bound(first, last, low);
    auto to = from;
    while (to != last && *to <= high) ++to;
    if (from != to) {
      consider(voxel_offsets_[static_cast<std::size_t>(from - voxel_x_.begin())],
               voxel_offsets_[static_cast<std::size_t>(to - voxel_x_.begin())]);
    }
  }

  // Call consider(first, last) for runs of sorted points that together hold all within radius.
  template <class Consider>
  void visit_runs(const Eigen::Vector3f& query, float radius, Consider&& consider) const {
    const double r = padded(query, radius);
    const std::optional<Box> box = radius >= 0 ? touched_box(query, r) : std::nullopt;
    if (!box) return;
    const auto [low, high] = *box;
    const auto consider_if_near = [&](std::uint32_t row, std::int64_t y, std::int64_t z) {
      const double left = r * r - squared_gap(query, y, z);
      if (left >= 0) consider_row(row, query, std::sqrt(left), consider);
    };

    // A ball that is large beside the voxels meets more rows than there are.
    const double num_touched =
        static_cast<double>(high[1] - low[1] + 1) * static_cast<double>(high[2] - low[2] + 1);
    if (num_touched > static_cast<double>(row_keys_.size())) {
      for (std::uint32_t row = 0; row < row_keys_.size(); ++row) {
        consider_if_near(row, row_y(row), row_z(row));
      }
      return;
    }
    for (std::int64_t z = low[2]; z <= high[2]; ++z) {
      for (std::int64_t y = low[1]; y <= high[1]; ++y) {
        const std::uint32_t row = find_row(y, z);
        if (row != kNoRow) consider_if_near(row, y, z);
      }
    }
  }

  VoxelLattice lattice_;
  Points sorted_;
  Column<std::uint32_t> indices_;        // per sorted point: its index in the input
  Column<std::uint32_t> voxel_x_;        // per voxel, in the order of the points
  Column<std::uint32_t> voxel_offsets_;  // per voxel (+ 1): its first sorted point
  Column<std::uint64_t> row_keys_;       // per row, rising: y + counts[1] * z
  Column<std::uint32_t> row_offsets_;    // per row (+ 1): its first voxel
  Column<std::uint32_t> table_;          // open addressing, at most half full: a row or kNoRow
  int table_shift_ = 63;
};

/// Count the neighbours of each query.
///
/// queries  m positions
/// radius   unit of the points; its sphere is included, and so is a query that is itself a point
/// out      m counts
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
void count_radius_neighbours(const VoxelHash& grid, PointsView queries, float radius,
                             std::span<std::uint32_t> out) noexcept;

/// Write the neighbours of each query, in the order of VoxelHash.
///
/// offsets  m + 1, the exclusive sums of the counts (see Neighbourhoods); offsets[0] need not be 0
/// indices  the whole column: row i goes to indices[offsets[i] .. offsets[i + 1])
/// Pre: queries and radius are those that were counted.
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
void fill_radius_neighbours(const VoxelHash& grid, PointsView queries, float radius,
                            std::span<const std::uint32_t> offsets,
                            std::span<std::uint32_t> indices) noexcept;

}  // namespace trivet::kernels
