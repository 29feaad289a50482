#include "kernels/spin_images/partial_views.hpp"

#include <algorithm>
#include <bit>
#include <numbers>

#include "storage/simd.hpp"

namespace trivet::kernels {
namespace {

using ViewCounts = std::array<std::uint16_t, kMostPartialViews>;

TRIVET_SIMD_CLONES
void add_bits(ViewBits bits, ViewCounts& counts) noexcept {
  for (std::size_t v = 0; v < counts.size(); ++v)
    counts[v] = static_cast<std::uint16_t>(counts[v] + (bits >> v & 1U));
}

/// Bit v of word p becomes bit p of word v.
/// Source: Warren, Hacker's Delight, 7-3.
void transpose(std::array<std::uint64_t, 64>& words) noexcept {
  std::uint64_t mask = 0x00000000FFFFFFFF;
  for (std::size_t step = 32; step != 0; step >>= 1U, mask ^= mask << step) {
    for (std::size_t k = 0; k < 64; k = ((k | step) + 1) & ~step) {
      const std::uint64_t change = ((words[k] >> step) ^ words[k | step]) & mask;
      words[k] ^= change << step;
      words[k | step] ^= change;
    }
  }
}

void find_seen(ViewedSupport& support) {
  support.num_words = (support.size + 63) / 64;
  support.seen.resize(std::max(support.seen.size(), kMostPartialViews * support.num_words));
  for (std::size_t w = 0; w < support.num_words; ++w) {
    std::array<std::uint64_t, 64> words{};
    const std::size_t n = std::min<std::size_t>(64, support.size - 64 * w);
    std::copy_n(support.views.begin() + static_cast<std::ptrdiff_t>(64 * w), n, words.begin());
    transpose(words);
    for (std::size_t v = 0; v < kMostPartialViews; ++v)
      support.seen[v * support.num_words + w] = words[v];
  }
}

TRIVET_SIMD_CLONES
std::size_t count_bits_of_xor(const std::uint64_t* a, const std::uint64_t* b,
                              std::size_t n) noexcept {
  std::size_t count = 0;
  for (std::size_t w = 0; w < n; ++w) count += static_cast<std::size_t>(std::popcount(a[w] ^ b[w]));
  return count;
}

}  // namespace

std::size_t count_differences(std::span<const std::uint64_t> a,
                              std::span<const std::uint64_t> b) noexcept {
  return count_bits_of_xor(a.data(), b.data(), a.size());
}

void count_sharers(const VoxelHash& grid, std::span<const ViewBits> views, PointsView points,
                   std::size_t first, float radius, std::span<std::uint8_t> counts) noexcept {
  for (std::size_t i = 0; i < points.size(); ++i) {
    ViewCounts sums{};
    grid.visit_within(points[i], radius,
                      [&](std::uint32_t near, float) { add_bits(views[near], sums); });
    for (std::size_t v = 0; v < kMostPartialViews; ++v) {
      counts[v * views.size() + first + i] =
          static_cast<std::uint8_t>(std::min<std::uint16_t>(sums[v], 255));
    }
  }
}

void gather_viewed_support(const VoxelHash& grid, std::span<const ViewBits> views,
                           const Eigen::Vector3f& keypoint, float radius, ViewedSupport& support) {
  support.size = 0;
  const float px = keypoint.x(), py = keypoint.y(), pz = keypoint.z(), limit = radius * radius;
  grid.visit_runs_within(keypoint, radius, [&](PointsView points, const std::uint32_t* indices) {
    const std::size_t needed = support.size + points.size();
    if (needed > support.x.size()) {
      for (Column<float>* const column : {&support.x, &support.y, &support.z})
        column->resize(2 * needed);
      support.index.resize(2 * needed);
      support.views.resize(2 * needed);
    }
    std::size_t kept = support.size;
    for (std::size_t i = 0; i < points.size(); ++i) {  // each is written, and overwritten if far
      const float dx = points.x[i] - px, dy = points.y[i] - py, dz = points.z[i] - pz;
      support.x[kept] = dx;
      support.y[kept] = dy;
      support.z[kept] = dz;
      support.index[kept] = indices[i];
      support.views[kept] = views[indices[i]];
      kept += dx * dx + dy * dy + dz * dz <= limit;
    }
    support.size = kept;
  });
  find_seen(support);
}

void take_view(const ViewedSupport& all, std::size_t view, std::span<const std::uint8_t> sharers,
               float share_radius, Support& support) {
  const std::size_t most = all.size + Support::kLanes;
  for (Column<float>* const column : {&support.x, &support.y, &support.z, &support.area}) {
    if (column->size() < most) column->resize(2 * most);
  }
  std::array<float, 256> areas{};  // by the number of sharers; no point that is seen has none
  for (std::size_t n = 1; n < areas.size(); ++n)
    areas[n] = std::numbers::pi_v<float> * share_radius * share_radius / static_cast<float>(n);
  float *const x = support.x.data(), *const y = support.y.data();
  float *const z = support.z.data(), *const area = support.area.data();
  std::size_t kept = 0;
  const auto seen = all.seen_by(view);
  for (std::size_t w = 0; w < seen.size(); ++w) {
    for (std::uint64_t bits = seen[w]; bits != 0; bits &= bits - 1, ++kept) {
      const std::size_t p = 64 * w + static_cast<std::size_t>(std::countr_zero(bits));
      x[kept] = all.x[p];
      y[kept] = all.y[p];
      z[kept] = all.z[p];
      area[kept] = areas[sharers[all.index[p]]];
    }
  }
  support.size = kept;
  for (Column<float>* const column : {&support.x, &support.y, &support.z, &support.area})
    std::fill_n(column->begin() + static_cast<std::ptrdiff_t>(kept), Support::kLanes, 0.0F);
}

}  // namespace trivet::kernels
