#include "kernels/common/voxel_hash.hpp"

#include <bit>
#include <limits>

#include "storage/common/precondition.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {

VoxelHash::VoxelHash(PointsView points, float cell) : lattice_(fit_lattice(points, cell)) {
  while (!lattice_.fits_64_bits()) lattice_ = fit_lattice(points, 2 * lattice_.cell);
  Voxels voxels;
  VoxelScratch scratch;
  group_by_voxel(points, lattice_, voxels, scratch);

  sorted_.resize(voxels.order.size());
  StopCheck check_stop(1 << 18);
  for (std::size_t i = 0; i < voxels.order.size(); ++i) {
    check_stop();
    sorted_.set(i, points[voxels.order[i]]);
  }

  // Voxels of one row are consecutive in x.
  const auto row_length = static_cast<std::uint64_t>(lattice_.counts[0]);
  rows_in_layer_ = static_cast<std::uint64_t>(lattice_.counts[1]);
  voxel_x_.reserve(voxels.size());
  for (std::uint32_t v = 0; v < voxels.size(); ++v) {
    check_stop();
    const std::uint64_t key = voxels.keys[v] / row_length;
    if (rows_.empty() || rows_.back().key != key) rows_.push_back({key, v, v});
    rows_.back().last = v + 1;
    voxel_x_.push_back(static_cast<std::uint32_t>(voxels.keys[v] % row_length));
  }
  indices_ = std::move(voxels.order);
  voxel_offsets_ = std::move(voxels.offsets);

  table_.resize(std::bit_ceil(2 * rows_.size() + 2));
  table_shift_ = 64 - std::countr_zero(table_.size());
  for (const Row& row : rows_) {
    check_stop();
    std::uint64_t s = slot(row.key);
    while (table_[s].key != kNoRow) s = (s + 1) & (table_.size() - 1);
    table_[s] = row;
  }
}

std::optional<VoxelHash::Ball> VoxelHash::ball(const Eigen::Vector3f& query,
                                               float radius) const noexcept {
  if (!query.allFinite() || !(radius >= 0) || indices_.empty()) return std::nullopt;
  std::array<double, 3> center;
  Ball b{};
  b.radius = padded_radius(query, radius);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double last = lattice_.counts[axis] - 1;
    center[axis] = query[static_cast<int>(axis)] * lattice_.inverse_cell - lattice_.lowest[axis];
    const double low = center[axis] - b.radius, high = center[axis] + b.radius;
    if (!(low <= last + 1 && high >= 0)) return std::nullopt;
    b.low[axis] = static_cast<std::int64_t>(std::clamp(low, 0.0, last));
    b.high[axis] = static_cast<std::int64_t>(std::min(high, last));
  }
  b.x = center[0];
  b.y = center[1];
  b.z = center[2];
  return b;
}

std::uint32_t VoxelHash::count_within(const Eigen::Vector3f& query, float radius) const noexcept {
  const PointsView sorted = sorted_;
  const float limit = radius * radius;
  std::uint32_t count = 0;
  visit_runs(query, radius, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      count += squared_distance(sorted, i, query) <= limit ? 1U : 0U;
    }
  });
  return count;
}

std::optional<VoxelHash::Nearest> VoxelHash::nearest(const Eigen::Vector3f& query,
                                                     float max_radius) const noexcept {
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  const PointsView sorted = sorted_;
  const std::optional<Ball> bounds = ball(query, max_radius);
  if (!bounds) return std::nullopt;
  const std::array<std::int64_t, 3>&low = bounds->low, &high = bounds->high;

  // The ball shrinks to the best point so far; ties go to the lower index.
  Nearest best{kNone, max_radius * max_radius};
  double radius = bounds->radius;
  const auto search_row = [&](const Row& row, std::int64_t y, std::int64_t z) {
    consider_row(row, *bounds, radius, y, z, [&](std::size_t first, std::size_t last) {
      const float before = best.squared_distance;
      for (std::size_t i = first; i < last; ++i) {
        const float d2 = squared_distance(sorted, i, query);
        if (d2 < best.squared_distance ||
            (d2 == best.squared_distance && indices_[i] < best.index)) {
          best = {indices_[i], d2};
        }
      }
      if (best.squared_distance < before) {
        radius = padded_radius(query, std::sqrt(static_cast<double>(best.squared_distance)));
      }
    });
  };

  // Rings of rows around the query's row, or around the nearest row of the box.
  const auto within = [](double value, std::int64_t first, std::int64_t last) {
    return static_cast<std::int64_t>(
        std::clamp(value, static_cast<double>(first), static_cast<double>(last)));
  };
  const std::int64_t y0 = within(bounds->y, low[1], high[1]),
                     z0 = within(bounds->z, low[2], high[2]);
  const std::int64_t last_ring = std::max({y0 - low[1], high[1] - y0, z0 - low[2], high[2] - z0});
  for (std::int64_t ring = 0; ring <= last_ring; ++ring) {
    if (static_cast<double>(ring - 1) > radius) break;
    if (static_cast<double>(ring) * static_cast<double>(ring) >
        static_cast<double>(rows_.size())) {  // mostly empty space: fewer rows than ring cells
      for (const Row& row : rows_) search_row(row, row_y(row), row_z(row));
      break;
    }
    for (std::int64_t z = std::max(z0 - ring, low[2]); z <= std::min(z0 + ring, high[2]); ++z) {
      const bool full_side = z == z0 - ring || z == z0 + ring;
      const std::int64_t step = full_side || ring == 0 ? 1 : 2 * ring;
      for (std::int64_t y = y0 - ring; y <= y0 + ring; y += step) {
        if (y < low[1] || y > high[1]) continue;
        const Row* row = find_row(y, z);
        if (row != nullptr) search_row(*row, y, z);
      }
    }
  }
  if (best.index == kNone) return std::nullopt;
  return best;
}

void count_radius_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                            std::span<std::uint32_t> out) {
  TRIVET_REQUIRE(out.size() == queries.size(), "one count per query");
  for (std::size_t i = 0; i < queries.size(); ++i) out[i] = grid.count_within(queries[i], radius);
}

void fill_radius_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                           std::span<const std::uint32_t> offsets,
                           std::span<std::uint32_t> indices) {
  TRIVET_REQUIRE(offsets.size() == queries.size() + 1, "one row per query");
  const PointsView sorted = grid.sorted_;
  const float limit = radius * radius;
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const Eigen::Vector3f query = queries[q];
    std::uint32_t* next = indices.data() + offsets[q];
    std::uint32_t* const end = indices.data() + offsets[q + 1];
    if (next == end) continue;
    // Each candidate is written and then kept or not, which avoids an unpredictable branch; when
    // the row is full, the next index is outside.
    grid.visit_runs(query, radius, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last && next != end; ++i) {
        *next = grid.indices_[i];
        next += VoxelHash::squared_distance(sorted, i, query) <= limit ? 1 : 0;
      }
    });
    TRIVET_REQUIRE(next == end, "rows hold what was counted");
  }
}

}  // namespace trivet::kernels
