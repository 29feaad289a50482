#include "kernels/pair_features/vote.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <numbers>

#include "kernels/common/fast_angle.hpp"
#include "storage/common/simd.hpp"

namespace trivet::kernels {

namespace {

/// The largest cell size (a power of two, exclusive) with which the look-ups give at most max_votes
/// votes; unlimited if all of them do.
std::uint32_t fullest_cell(std::span<const SceneVote> votes, const std::uint32_t* offsets,
                           std::uint64_t max_votes) noexcept {
  std::array<std::uint64_t, 33> votes_of_width{};
  for (const SceneVote& vote : votes) {
    const std::uint32_t size = offsets[vote.cell + 1] - offsets[vote.cell];
    votes_of_width[static_cast<std::size_t>(std::bit_width(size))] += size;
  }
  std::uint64_t sum = 0;
  for (std::uint32_t width = 1; width < votes_of_width.size(); ++width) {
    sum += votes_of_width[width];
    if (sum > max_votes) return std::uint32_t{1} << (width - 1);
  }
  return ~std::uint32_t{0};
}

}  // namespace

std::uint64_t cast_votes(std::span<const SceneVote> votes, const PpfTableView& table,
                         std::uint64_t max_votes, std::span<std::uint16_t> accumulator) noexcept {
  assert(votes.size() < 8192 && "counters of 16 bits");
  // Cells are sorted: from the first cell beyond the table on, pairs are longer than this model.
  const std::uint32_t num_cells = table.quantization.num_cells();
  const auto beyond = std::partition_point(
      votes.begin(), votes.end(), [&](const SceneVote& vote) { return vote.cell < num_cells; });
  votes = votes.first(static_cast<std::size_t>(beyond - votes.begin()));

  if (accumulator.empty()) return 0;
  const std::uint32_t* const offsets = table.offsets.data();
  const PpfEntry* const entries = table.entries.data();
  std::uint16_t* const counters = accumulator.data();
  // The table may lie in a file that is being written: no value in it may cause an access to other
  // memory.
  const auto num_entries = static_cast<std::uint32_t>(table.entries.size());
  const auto last_row = static_cast<std::uint32_t>(accumulator.size() / kRotationBins - 1);
  const std::uint32_t too_full = fullest_cell(votes, offsets, max_votes);
  constexpr std::size_t kPrefetchDistance = 8;  // look-ups whose entries are prefetched
  std::uint64_t total = 0;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    if (i + kPrefetchDistance < votes.size())
      __builtin_prefetch(entries + offsets[votes[i + kPrefetchDistance].cell]);
    const std::uint32_t first = offsets[votes[i].cell];
    const std::uint32_t last = std::min(offsets[votes[i].cell + 1], num_entries);
    if (last - first >= too_full) continue;
    const std::uint16_t rotation = votes[i].rotation;
    for (std::uint32_t e = first; e < last; ++e) {
      const std::uint32_t bin =
          static_cast<std::uint16_t>(entries[e].angle - rotation) >> kRotationShift;
      ++counters[std::min<std::uint32_t>(entries[e].reference, last_row) * kRotationBins + bin];
    }
    total += last - first;
  }
  return total;
}

namespace {

/// The largest three-bin sum over all model points.
TRIVET_SIMD_CLONES
std::uint32_t highest_peak(const std::uint16_t* __restrict accumulator,
                           std::size_t num_rows) noexcept {
  std::uint32_t best = 0;
  for (std::size_t row = 0; row < num_rows; ++row) {
    const std::uint16_t* const bins = accumulator + row * kRotationBins;
    for (std::uint32_t k = 1; k + 1 < kRotationBins; ++k) {
      best = std::max<std::uint32_t>(best, std::uint32_t{bins[k - 1]} + bins[k] + bins[k + 1]);
    }
    const std::uint32_t ends = std::uint32_t{bins[kRotationBins - 1]} + bins[0];
    best = std::max({best, ends + bins[1], ends + bins[kRotationBins - 2]});
  }
  return best;
}

VotePeak peak_of_row(std::span<const std::uint16_t> bins, std::uint32_t model_point) noexcept {
  std::uint32_t best = 0, best_bin = 0;
  for (std::uint32_t k = 0; k < kRotationBins; ++k) {
    const std::uint32_t sum = std::uint32_t{bins[(k + kRotationBins - 1) % kRotationBins]} +
                              bins[k] + bins[(k + 1) % kRotationBins];
    if (sum > best) {
      best = sum;
      best_bin = k;
    }
  }
  const float left = bins[(best_bin + kRotationBins - 1) % kRotationBins];
  const float right = bins[(best_bin + 1) % kRotationBins];
  const float bin = static_cast<float>(best_bin) + 0.5F +
                    (right - left) / std::max(1.0F, static_cast<float>(best));
  return {model_point, bin * (2 * std::numbers::pi_v<float> / static_cast<float>(kRotationBins)),
          best};
}

}  // namespace

VotePeaks extract_peaks(std::span<std::uint16_t> accumulator, std::size_t max_peaks,
                        float share) noexcept {
  assert(max_peaks >= 1 && max_peaks <= kMaxPeaks && "peaks are kept in a fixed array");
  VotePeaks peaks;
  const std::size_t num_rows = accumulator.size() / kRotationBins;
  const std::uint32_t highest = highest_peak(accumulator.data(), num_rows);
  if (highest == 0) return peaks;

  const std::uint32_t floor = std::max<std::uint32_t>(
      1, static_cast<std::uint32_t>(std::ceil(share * static_cast<float>(highest))));
  for (std::size_t row = 0; row < num_rows; ++row) {
    const auto bins = accumulator.subspan(row * kRotationBins, kRotationBins);
    std::uint16_t largest = 0;
    for (const std::uint16_t count : bins) largest = std::max(largest, count);
    if (3U * largest < floor) continue;  // no three bins can reach the floor
    const VotePeak peak = peak_of_row(bins, static_cast<std::uint32_t>(row));
    if (peak.votes < floor) continue;
    std::size_t at = peaks.count;
    while (at > 0 && peaks.peak[at - 1].votes < peak.votes) --at;
    if (at == max_peaks) continue;
    peaks.count = std::min(peaks.count + 1, max_peaks);
    for (std::size_t k = peaks.count - 1; k > at; --k) peaks.peak[k] = peaks.peak[k - 1];
    peaks.peak[at] = peak;
  }
  std::fill(accumulator.begin(), accumulator.end(), std::uint16_t{0});
  return peaks;
}

}  // namespace trivet::kernels
