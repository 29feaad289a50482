#include "kernels/common/voxels.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "storage/common/precondition.hpp"
#include "storage/common/simd.hpp"
#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

constexpr double kMaxAxis = 4294967296.0;  // 2^32 voxels along an axis

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
  TRIVET_REQUIRE(cell > 0 && std::isfinite(cell), "a voxel has an extent");
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

namespace {

constexpr std::size_t kNumbered = 256;  // points keyed at a time
constexpr std::uint64_t kNoVoxel = ~std::uint64_t{0};
constexpr double kMaxFast = 4503599627370496.0;  // 2^52
constexpr std::uint64_t kLowBits = (std::uint64_t{1} << 52) - 1;

/// Keys of voxels below 2^52, exact in double; kNoVoxel for non-finite points. In the sum with
/// 2^52, a whole number occupies the double's low bits.
TRIVET_SIMD_CLONES
void number_voxels(const VoxelLattice& lattice, std::size_t n, const float* __restrict x,
                   const float* __restrict y, const float* __restrict z,
                   std::uint64_t* __restrict numbers) noexcept {
  const double inverse = lattice.inverse_cell;
  const auto [low_x, low_y, low_z] = lattice.lowest;
  const double num_x = lattice.counts[0], num_y = lattice.counts[1];
  for (std::size_t i = 0; i < n; ++i) {
    const double at_x = std::floor(x[i] * inverse) - low_x;
    const double at_y = std::floor(y[i] * inverse) - low_y;
    const double at_z = std::floor(z[i] * inverse) - low_z;
    const auto bits = std::bit_cast<std::uint64_t>((at_z * num_y + at_y) * num_x + at_x + kMaxFast);
    const bool is_finite = (x[i] - x[i] == 0) & (y[i] - y[i] == 0) & (z[i] - z[i] == 0);
    numbers[i] = is_finite ? bits & kLowBits : kNoVoxel;
  }
}

/// Sort runs of consecutive points of one voxel.
void sort_runs(PointsView points, const VoxelLattice& lattice, Voxels& out, VoxelScratch& scratch) {
  std::array<std::uint64_t, kNumbered> numbers;
  std::uint64_t last = kNoVoxel;
  StopCheck check_stop(StopCheck::kPoints / kNumbered);
  for (std::size_t begin = 0; begin < points.size(); begin += kNumbered) {
    check_stop();
    const std::size_t n = std::min(kNumbered, points.size() - begin);
    number_voxels(lattice, n, &points.x[begin], &points.y[begin], &points.z[begin], numbers.data());
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<std::uint32_t>(begin + k);
      if (numbers[k] != last && numbers[k] != kNoVoxel) {
        out.keys.push_back(numbers[k]);
        scratch.first.push_back(i);
        scratch.end.push_back(i);
      }
      last = numbers[k];
      if (last != kNoVoxel) scratch.end.back() = i + 1;
    }
  }
  for (std::uint32_t run = 0; run < out.keys.size(); ++run) out.order.push_back(run);
  const auto [num_x, num_y, num_z] = lattice.counts;
  radix_sort(out.keys, out.order, static_cast<std::uint64_t>(num_x * num_y * num_z) - 1,
             scratch.sort);
}

/// The same with every point as a separate run, for lattices of any extent.
void sort_points(PointsView points, const VoxelLattice& lattice, Voxels& out,
                 VoxelScratch& scratch) {
  // If one key cannot hold a voxel, sort by (y, x) first and replace both by their rank.
  const bool fits = lattice.fits_64_bits();
  const auto axis_count = [&](std::size_t axis) {
    return static_cast<std::uint64_t>(std::min(lattice.counts[axis], kMaxAxis));
  };
  const std::uint64_t nx = axis_count(0), ny = axis_count(1), nz = axis_count(2);
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t i = 0; i < points.size(); ++i) {
    check_stop();
    if (!finite(points, i)) continue;
    std::uint64_t key = voxel_on_axis(lattice, points.y[i], 1);
    if (fits) key += ny * voxel_on_axis(lattice, points.z[i], 2);
    out.keys.push_back(key * nx + voxel_on_axis(lattice, points.x[i], 0));
    out.order.push_back(static_cast<std::uint32_t>(out.order.size()));
    scratch.first.push_back(static_cast<std::uint32_t>(i));
    scratch.end.push_back(static_cast<std::uint32_t>(i + 1));
  }
  radix_sort(out.keys, out.order, fits ? nx * ny * nz - 1 : nx * ny - 1, scratch.sort);
  if (!fits) {
    const std::uint64_t stride = rank_keys(out.keys) + 1;
    for (std::size_t k = 0; k < out.keys.size(); ++k) {
      out.keys[k] += stride * voxel_on_axis(lattice, points.z[scratch.first[out.order[k]]], 2);
    }
    radix_sort(out.keys, out.order, stride * nz - 1, scratch.sort);
  }
}

}  // namespace

void group_by_voxel(PointsView points, const VoxelLattice& lattice, Voxels& out,
                    VoxelScratch& scratch) {
  out.keys.clear();
  out.order.clear();
  scratch.first.clear();
  scratch.end.clear();
  const bool is_fast = lattice.counts[0] * lattice.counts[1] * lattice.counts[2] < kMaxFast;
  (is_fast ? sort_runs : sort_points)(points, lattice, out, scratch);

  // Keep one key per voxel and the start of its points, and write the runs out.
  Column<std::uint32_t>& order = scratch.sort.values;
  order.clear();
  out.offsets.clear();
  std::size_t num_voxels = 0;
  StopCheck check_stop(StopCheck::kPoints);
  for (std::size_t k = 0; k < out.keys.size(); ++k) {
    check_stop();
    if (k == 0 || out.keys[k] != out.keys[num_voxels - 1]) {
      out.keys[num_voxels++] = out.keys[k];
      out.offsets.push_back(static_cast<std::uint32_t>(order.size()));
    }
    const std::uint32_t run = out.order[k];
    for (std::uint32_t i = scratch.first[run]; i < scratch.end[run]; ++i) order.push_back(i);
  }
  out.keys.resize(num_voxels);
  out.offsets.push_back(static_cast<std::uint32_t>(order.size()));
  out.order.swap(order);
}

}  // namespace trivet::kernels
