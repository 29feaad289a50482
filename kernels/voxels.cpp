#include "kernels/voxels.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

namespace trivet::kernels {
namespace {

constexpr double kMaxAxis = 4294967296.0;  // 2^32 voxels on an axis

bool finite(PointsView points, std::size_t i) {
  return std::isfinite(points.x[i]) && std::isfinite(points.y[i]) && std::isfinite(points.z[i]);
}

std::uint64_t voxel_on_axis(const VoxelLattice& lattice, float value, int axis) {
  return static_cast<std::uint64_t>(std::min(lattice.coordinate(value, axis), kMaxAxis - 1));
}

// Replace each key by its rank among the different keys; both columns are sorted by key.
std::uint64_t rank_keys(Column<std::uint64_t>& keys) {
  std::uint64_t rank = 0, previous = keys.empty() ? 0 : keys.front();
  for (std::uint64_t& key : keys) {
    if (key != previous) ++rank;
    previous = key;
    key = rank;
  }
  return rank;
}

}  // namespace

bool VoxelLattice::fits_64_bits() const noexcept {
  const auto [x, y, z] = counts;
  return x <= kMaxAxis && y <= kMaxAxis && z <= kMaxAxis && x * y * z < 18446744073709549568.0;
}

VoxelLattice fit_lattice(PointsView points, double cell) {
  assert(cell > 0 && std::isfinite(cell) && "a voxel has an extent");
  VoxelLattice lattice{.cell = cell, .inverse_cell = 1 / cell};
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, 3> low, high;
  low.fill(kInfinity);
  high.fill(-kInfinity);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!finite(points, i)) continue;
    const std::array<float, 3> p{points.x[i], points.y[i], points.z[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  if (low[0] > high[0]) return lattice;  // no finite point
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lattice.lowest[axis] = std::floor(low[axis] * lattice.inverse_cell);
    lattice.counts[axis] = lattice.coordinate(high[axis], static_cast<int>(axis)) + 1;
  }
  return lattice;
}

void group_by_voxel(PointsView points, const VoxelLattice& lattice, Voxels& out,
                    RadixScratch& scratch) {
  const std::size_t n = points.size();
  out.keys.clear();
  out.order.clear();
  out.keys.reserve(n);
  out.order.reserve(n);

  // Where one number cannot hold a voxel, sort by (y, x) first and let its rank stand for both.
  const bool fits = lattice.fits_64_bits();
  const auto axis_count = [&](std::size_t axis) {
    return static_cast<std::uint64_t>(std::min(lattice.counts[axis], kMaxAxis));
  };
  const std::uint64_t nx = axis_count(0), ny = axis_count(1), nz = axis_count(2);
  for (std::size_t i = 0; i < n; ++i) {
    if (!finite(points, i)) continue;
    std::uint64_t key = voxel_on_axis(lattice, points.y[i], 1);
    if (fits) key += ny * voxel_on_axis(lattice, points.z[i], 2);
    out.keys.push_back(key * nx + voxel_on_axis(lattice, points.x[i], 0));
    out.order.push_back(static_cast<std::uint32_t>(i));
  }
  radix_sort(out.keys, out.order, fits ? nx * ny * nz - 1 : nx * ny - 1, scratch);
  if (!fits) {
    const std::uint64_t stride = rank_keys(out.keys) + 1;
    for (std::size_t i = 0; i < out.keys.size(); ++i) {
      out.keys[i] += stride * voxel_on_axis(lattice, points.z[out.order[i]], 2);
    }
    radix_sort(out.keys, out.order, stride * nz - 1, scratch);
  }

  // Keep one key a voxel and where its points begin.
  out.offsets.clear();
  std::size_t num_voxels = 0;
  for (std::size_t i = 0; i < out.keys.size(); ++i) {
    if (i > 0 && out.keys[i] == out.keys[num_voxels - 1]) continue;
    out.keys[num_voxels++] = out.keys[i];
    out.offsets.push_back(static_cast<std::uint32_t>(i));
  }
  out.keys.resize(num_voxels);
  out.offsets.push_back(static_cast<std::uint32_t>(out.order.size()));
}

}  // namespace trivet::kernels
