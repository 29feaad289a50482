/// Voting for the poses of one model from one scene reference point.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "kernels/pair_features/scene_pairs.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/ppf_table.hpp"

namespace trivet::kernels {

/// A peak of the accumulator: this model point lies on the reference point, rotated by this angle.
struct VotePeak {
  std::uint32_t model_point = 0;
  float rotation_rad = 0;   ///< alpha, averaged over the peak's three bins by votes
  std::uint32_t votes = 0;  ///< sum of the peak's three bins
};

inline constexpr std::size_t kMaxPeaks = 8;

struct VotePeaks {
  std::array<VotePeak, kMaxPeaks> peak;  ///< by descending votes, ties by lowest model point
  std::size_t count = 0;
};

/// Add one vote per table entry of every look-up to accumulator[model point][rotation bin].
///
/// votes        look-ups sorted by cell; cells beyond the table are skipped
/// max_votes    bound on the number of votes. The fullest cells, which are least distinctive, are
///              skipped until it holds (in steps of a factor of 2 of the cells' size), so that flat
///              and repetitive models cost no more than others
/// accumulator  num_model_points * kRotationBins counters, zero on entry
/// Returns the number of votes. A counter cannot overflow with fewer than 8192 look-ups: points lie
/// at least a step apart, so a cell holds at most 8 entries of one reference within one rotation
/// bin. Source: Drost et al., CVPR 2010, section 3.3, with alpha wrapped by 16-bit arithmetic.
std::uint64_t cast_votes(std::span<const SceneVote> votes, const PpfTableView& table,
                         std::uint64_t max_votes, std::span<std::uint16_t> accumulator) noexcept;

/// Find the highest peaks, at most one per model point, and reset the accumulator to zero.
///
/// A peak's votes are summed over its bin and both neighbors (the rotation wraps), which equals
/// spreading each vote (Hinterstoisser et al., ECCV 2016). Peaks below `share` of the highest are
/// omitted.
VotePeaks extract_peaks(std::span<std::uint16_t> accumulator, std::size_t max_peaks,
                        float share) noexcept;

}  // namespace trivet::kernels
