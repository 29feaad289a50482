#include "kernels/voxel_hash.hpp"

#include <bit>
#include <cassert>
#include <limits>

namespace trivet::kernels {

VoxelHash::VoxelHash(PointsView points, float cell) : lattice_(fit_lattice(points, cell)) {
  while (!lattice_.fits_64_bits()) lattice_ = fit_lattice(points, 2 * lattice_.cell);
  Voxels voxels;
  RadixScratch scratch;
  group_by_voxel(points, lattice_, voxels, scratch);

  sorted_.resize(voxels.order.size());
  for (std::size_t i = 0; i < voxels.order.size(); ++i) sorted_.set(i, points[voxels.order[i]]);

  // Voxels of one row follow each other in x.
  const auto row_length = static_cast<std::uint64_t>(lattice_.counts[0]);
  for (std::size_t v = 0; v < voxels.size(); ++v) {
    const std::uint64_t row_key = voxels.keys[v] / row_length;
    if (row_keys_.empty() || row_keys_.back() != row_key) {
      row_keys_.push_back(row_key);
      row_offsets_.push_back(static_cast<std::uint32_t>(v));
    }
    voxel_x_.push_back(static_cast<std::uint32_t>(voxels.keys[v] % row_length));
  }
  row_offsets_.push_back(static_cast<std::uint32_t>(voxels.size()));
  indices_ = std::move(voxels.order);
  voxel_offsets_ = std::move(voxels.offsets);

  table_.assign(std::bit_ceil(2 * row_keys_.size() + 2), kNoRow);
  table_shift_ = 64 - std::countr_zero(table_.size());
  for (std::uint32_t row = 0; row < row_keys_.size(); ++row) {
    std::uint64_t s = slot(row_keys_[row]);
    while (table_[s] != kNoRow) s = (s + 1) & (table_.size() - 1);
    table_[s] = row;
  }
}

std::optional<VoxelHash::Box> VoxelHash::touched_box(const Eigen::Vector3f& query,
                                                     double radius) const noexcept {
  if (!query.allFinite() || indices_.empty()) return std::nullopt;
  Box box{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double last = lattice_.counts[a] - 1;
    const double low = lattice_.coordinate(query[axis] - radius, axis);
    const double high = lattice_.coordinate(query[axis] + radius, axis);
    if (!(low <= last && high >= 0)) return std::nullopt;
    box.low[a] = static_cast<std::int64_t>(std::max(low, 0.0));
    box.high[a] = static_cast<std::int64_t>(std::min(high, last));
  }
  return box;
}

double VoxelHash::squared_gap(const Eigen::Vector3f& query, std::int64_t y,
                              std::int64_t z) const noexcept {
  const auto gap = [&](double value, double voxel) {
    return std::max({0.0, voxel * lattice_.cell - value, value - (voxel + 1) * lattice_.cell});
  };
  const double gap_y = gap(query.y(), lattice_.lowest[1] + static_cast<double>(y));
  const double gap_z = gap(query.z(), lattice_.lowest[2] + static_cast<double>(z));
  return gap_y * gap_y + gap_z * gap_z;
}

std::int64_t VoxelHash::row_y(std::uint32_t row) const noexcept {
  return static_cast<std::int64_t>(row_keys_[row] % static_cast<std::uint64_t>(lattice_.counts[1]));
}

std::int64_t VoxelHash::row_z(std::uint32_t row) const noexcept {
  return static_cast<std::int64_t>(row_keys_[row] / static_cast<std::uint64_t>(lattice_.counts[1]));
}

std::uint32_t VoxelHash::find_row(std::int64_t y, std::int64_t z) const noexcept {
  const auto rows_in_layer = static_cast<std::uint64_t>(lattice_.counts[1]);
  const std::uint64_t key =
      static_cast<std::uint64_t>(y) + rows_in_layer * static_cast<std::uint64_t>(z);
  std::uint64_t s = slot(key);
  while (table_[s] != kNoRow && row_keys_[table_[s]] != key) s = (s + 1) & (table_.size() - 1);
  return table_[s];
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
  const std::optional<Box> box =
      max_radius >= 0 ? touched_box(query, padded(query, max_radius)) : std::nullopt;
  if (!box) return std::nullopt;
  const auto [low, high] = *box;

  // The ball shrinks to the best point so far; ties in distance go to the lower index.
  Nearest best{kNone, max_radius * max_radius};
  const auto search_row = [&](std::uint32_t row, std::int64_t y, std::int64_t z) {
    const double r = padded(query, std::sqrt(static_cast<double>(best.squared_distance)));
    const double left = r * r - squared_gap(query, y, z);
    if (!(left >= 0)) return;
    consider_row(row, query, std::sqrt(left), [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const float d2 = squared_distance(sorted, i, query);
        if (d2 < best.squared_distance ||
            (d2 == best.squared_distance && indices_[i] < best.index)) {
          best = {indices_[i], d2};
        }
      }
    });
  };

  // Rings of rows around the query's own, or around the box's row that is nearest to it.
  const auto nearest_row = [&](int axis) {
    const auto a = static_cast<std::size_t>(axis);
    return static_cast<std::int64_t>(std::clamp(lattice_.coordinate(query[axis], axis),
                                                static_cast<double>(low[a]),
                                                static_cast<double>(high[a])));
  };
  const std::int64_t y0 = nearest_row(1), z0 = nearest_row(2);
  const std::int64_t last_ring = std::max({y0 - low[1], high[1] - y0, z0 - low[2], high[2] - z0});
  for (std::int64_t ring = 0; ring <= last_ring; ++ring) {
    const double bound = static_cast<double>(ring - 1) * lattice_.cell;
    const double r = padded(query, std::sqrt(static_cast<double>(best.squared_distance)));
    if (bound > r) break;
    if (static_cast<double>(ring) * static_cast<double>(ring) >
        static_cast<double>(row_keys_.size())) {  // emptiness all around: fewer rows than voxels
      for (std::uint32_t row = 0; row < row_keys_.size(); ++row) {
        search_row(row, row_y(row), row_z(row));
      }
      break;
    }
    for (std::int64_t z = std::max(z0 - ring, low[2]); z <= std::min(z0 + ring, high[2]); ++z) {
      const bool whole_side = z == z0 - ring || z == z0 + ring;
      const std::int64_t step = whole_side || ring == 0 ? 1 : 2 * ring;
      for (std::int64_t y = y0 - ring; y <= y0 + ring; y += step) {
        if (y < low[1] || y > high[1]) continue;
        const std::uint32_t row = find_row(y, z);
        if (row != kNoRow) search_row(row, y, z);
      }
    }
  }
  if (best.index == kNone) return std::nullopt;
  return best;
}

void count_radius_neighbours(const VoxelHash& grid, PointsView queries, float radius,
                             std::span<std::uint32_t> out) noexcept {
  assert(out.size() == queries.size() && "one count per query");
  for (std::size_t i = 0; i < queries.size(); ++i) out[i] = grid.count_within(queries[i], radius);
}

void fill_radius_neighbours(const VoxelHash& grid, PointsView queries, float radius,
                            std::span<const std::uint32_t> offsets,
                            std::span<std::uint32_t> indices) noexcept {
  assert(offsets.size() == queries.size() + 1 && "one row per query");
  for (std::size_t i = 0; i < queries.size(); ++i) {
    std::size_t next = offsets[i];
    grid.visit_within(queries[i], radius,
                      [&](std::uint32_t index, float) { indices[next++] = index; });
    assert(next == offsets[i + 1] && "rows hold what was counted");
  }
}

}  // namespace trivet::kernels
