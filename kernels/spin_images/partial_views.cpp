#include "kernels/spin_images/partial_views.hpp"

#include <algorithm>
#include <bit>
#include <numbers>

#include "storage/common/simd.hpp"

namespace trivet::kernels {
namespace {

/// Plane p holds bit p of the counters of all views.
using BitCounters = std::array<std::uint64_t, 8>;

/// Add the set bits to the counters, saturating at 255.
void add(ViewBits bits, BitCounters& counters) noexcept {
  for (std::uint64_t& plane : counters) {
    const std::uint64_t carry = plane & bits;
    plane ^= bits;
    bits = carry;
    if (bits == 0) return;
  }
  for (std::uint64_t& plane : counters) plane |= bits;
}

/// Expand eight bits to bytes: byte k is bit k as 0 or 1.
std::uint64_t spread(std::uint64_t bits) noexcept {
  bits = (bits | bits << 28) & 0x0000000F0000000F;
  bits = (bits | bits << 14) & 0x0003000300030003;
  return (bits | bits << 7) & 0x0101010101010101;
}

/// The counts of eight views from `first` on, one byte each; planes from num_planes on are empty.
std::uint64_t eight_counts(std::size_t first, const BitCounters& counters,
                           std::size_t num_planes) noexcept {
  std::uint64_t counts = 0;
  for (std::size_t p = 0; p < num_planes; ++p) counts |= spread(counters[p] >> first & 0xFF) << p;
  return counts;
}

using Square = std::array<std::uint64_t, 64>;

/// In each square of twice `Half` bits, swap the two off-diagonal squares of `Half` bits.
template <std::size_t Half>
[[gnu::always_inline]] inline void swap_halves(Square& square) noexcept {
  constexpr std::uint64_t kLow = ~std::uint64_t{0} / ((std::uint64_t{1} << Half) + 1);
  for (std::size_t block = 0; block < square.size(); block += 2 * Half) {
    for (std::size_t i = block; i < block + Half; ++i) {
      const std::uint64_t swapped = ((square[i] >> Half) ^ square[i + Half]) & kLow;
      square[i] ^= swapped << Half;
      square[i + Half] ^= swapped;
    }
  }
}

/// Transpose bits: bit v of word p becomes bit p of word v.
/// Source: Warren, Hacker's Delight, 7-3.
TRIVET_SIMD_CLONES
void transpose(Square& square) noexcept {
  swap_halves<32>(square);
  swap_halves<16>(square);
  swap_halves<8>(square);
  swap_halves<4>(square);
  swap_halves<2>(square);
  swap_halves<1>(square);
}

void find_visible(std::span<const ViewBits> views, ViewedSupport& support) {
  support.num_words = (support.size + 63) / 64;
  support.visible.resize(std::max(support.visible.size(), kMostPartialViews * support.num_words));
  for (std::size_t w = 0; w < support.num_words; ++w) {
    Square square{};
    const std::size_t n = std::min<std::size_t>(64, support.size - 64 * w);
    for (std::size_t k = 0; k < n; ++k) square[k] = views[support.places[64 * w + k]];
    transpose(square);
    for (std::size_t v = 0; v < kMostPartialViews; ++v)
      support.visible[v * support.num_words + w] = square[v];
  }
}

TRIVET_SIMD_CLONES
std::uint32_t count_differences(const std::uint64_t* a, const std::uint64_t* b,
                                std::size_t n) noexcept {
  std::uint32_t count = 0;
  for (std::size_t w = 0; w < n; ++w)
    count += static_cast<std::uint32_t>(std::popcount(a[w] ^ b[w]));
  return count;
}

TRIVET_SIMD_CLONES
std::uint32_t count_points(const std::uint64_t* visible, std::size_t n) noexcept {
  std::uint32_t count = 0;
  for (std::size_t w = 0; w < n; ++w)
    count += static_cast<std::uint32_t>(std::popcount(visible[w]));
  return count;
}

}  // namespace

Sharers::Sharers(std::size_t all_points, float within)
    : num_points(all_points), radius(within), counts(kMostPartialViews * all_points) {
  for (std::size_t n = 1; n < areas.size(); ++n)
    areas[n] = std::numbers::pi_v<float> * radius * radius / static_cast<float>(n);
}

void count_sharers(const VoxelHash& grid, std::span<const ViewBits> views, PointsView points,
                   std::size_t first, Sharers& sharers) noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) {
    BitCounters counters{};
    grid.visit_within(points[i], sharers.radius,
                      [&](std::uint32_t near, float) { add(views[near], counters); });
    std::size_t num_planes = counters.size();
    while (num_planes > 0 && counters[num_planes - 1] == 0) --num_planes;
    for (std::size_t v = 0; v < kMostPartialViews; v += 8) {
      const std::uint64_t eight = eight_counts(v, counters, num_planes);
      for (std::size_t k = 0; k < 8; ++k)
        sharers.counts[(v + k) * views.size() + first + i] =
            static_cast<std::uint8_t>(eight >> 8 * k);
    }
  }
}

void gather_viewed_support(const VoxelHash& grid, std::span<const ViewBits> views,
                           const Eigen::Vector3f& keypoint, float radius, ViewedSupport& support) {
  support.keypoint = keypoint;
  support.size = 0;
  const float px = keypoint.x(), py = keypoint.y(), pz = keypoint.z(), limit = radius * radius;
  grid.visit_runs_within(keypoint, radius, [&](PointsView points, const std::uint32_t* indices) {
    const auto before = static_cast<std::uint32_t>(indices - grid.order().data());
    const std::size_t needed = support.size + points.size();
    if (needed > support.places.size()) support.places.resize(2 * needed);
    std::uint32_t* const places = support.places.data();
    std::size_t kept = support.size;
    for (std::uint32_t i = 0; i < points.size(); ++i) {  // branch-free: entries that are too far
                                                         // are overwritten
      const float dx = points.x[i] - px, dy = points.y[i] - py, dz = points.z[i] - pz;
      places[kept] = before + i;
      kept += dx * dx + dy * dy + dz * dz <= limit;
    }
    support.size = kept;
  });
  find_visible(views, support);
}

void extract_view(const VoxelHash& grid, const ViewedSupport& all, std::size_t view,
                  const Sharers& sharers, Support& support) {
  const std::size_t most = all.size + Support::kLanes;
  for (Column<float>* const column : {&support.x, &support.y, &support.z, &support.area}) {
    if (column->size() < most) column->resize(2 * most);
  }
  float *const x = support.x.data(), *const y = support.y.data();
  float *const z = support.z.data(), *const area = support.area.data();
  const float px = all.keypoint.x(), py = all.keypoint.y(), pz = all.keypoint.z();
  const PointsView points = grid.ordered_points();
  const std::uint8_t* const counts = sharers.of_view(view).data();
  std::size_t kept = 0;
  const auto visible = all.visible_in(view);
  for (std::size_t w = 0; w < visible.size(); ++w) {
    for (std::uint64_t bits = visible[w]; bits != 0; bits &= bits - 1, ++kept) {
      const std::uint32_t p = all.places[64 * w + static_cast<std::size_t>(std::countr_zero(bits))];
      x[kept] = points.x[p] - px;
      y[kept] = points.y[p] - py;
      z[kept] = points.z[p] - pz;
      area[kept] = sharers.areas[counts[p]];
    }
  }
  support.size = kept;
  for (Column<float>* const column : {&support.x, &support.y, &support.z, &support.area})
    std::fill_n(column->begin() + static_cast<std::ptrdiff_t>(kept), Support::kLanes, 0.0F);
}

void compare_views(const ViewedSupport& all, ViewBits wanted, float share,
                   LikeViews& views) noexcept {
  for (ViewBits rest = wanted; rest != 0; rest &= rest - 1) {
    const auto a = static_cast<std::size_t>(std::countr_zero(rest));
    views.sizes[a] = count_points(all.visible_in(a).data(), all.num_words);
    views.alike[a] = ViewBits{1} << a;
    for (ViewBits before = wanted ^ rest; before != 0; before &= before - 1) {
      const auto b = static_cast<std::size_t>(std::countr_zero(before));
      const std::uint32_t differing =
          count_differences(all.visible_in(a).data(), all.visible_in(b).data(), all.num_words);
      const auto both = static_cast<float>(views.sizes[a] + views.sizes[b]);
      if (2 * static_cast<float>(differing) > share * both) continue;
      views.alike[a] |= ViewBits{1} << b;
      views.alike[b] |= ViewBits{1} << a;
    }
  }
}

std::size_t most_typical(const LikeViews& views, ViewBits left) noexcept {
  std::size_t best = 0;
  int most = 0;
  for (ViewBits rest = left; rest != 0; rest &= rest - 1) {
    const auto v = static_cast<std::size_t>(std::countr_zero(rest));
    const int alike = std::popcount(views.alike[v] & left);
    if (alike <= most) continue;
    most = alike;
    best = v;
  }
  return best;
}

}  // namespace trivet::kernels
