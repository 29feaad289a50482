#include "kernels/pair_features/vote.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_ppf.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::OrientedCloud;
using test::Random;

constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};
constexpr double kBinRad = 2 * reference::kPi / kRotationBins;

/// A table of 54 cells with some empty ones and sizes up to 40, and 200 look-ups, sorted.
struct Votes {
  PpfQuantization quantization{1, 2, 3};
  std::size_t num_points = 20;
  std::vector<std::uint32_t> offsets{0};
  std::vector<PpfEntry> entries;
  std::vector<SceneVote> votes;

  explicit Votes(Random& random) {
    for (std::uint32_t cell = 0; cell < quantization.num_cells(); ++cell) {
      const std::uint32_t size = random.below(3) == 0 ? 0 : random.below(1 + random.below(40));
      for (std::uint32_t e = 0; e < size; ++e) {
        entries.push_back({static_cast<std::uint16_t>(random.below(20)),
                           static_cast<std::uint16_t>(random.below(65536))});
      }
      offsets.push_back(static_cast<std::uint32_t>(entries.size()));
    }
    for (int k = 0; k < 200; ++k) {
      votes.push_back({random.below(quantization.num_cells()),
                       static_cast<std::uint16_t>(random.below(65536))});
    }
    sort();
  }
  void sort() { std::ranges::stable_sort(votes, {}, &SceneVote::cell); }
  PpfTableView table() const {
    return {.quantization = quantization, .offsets = offsets, .entries = entries};
  }
  std::uint32_t cell_size(std::uint32_t cell) const { return offsets[cell + 1] - offsets[cell]; }
};

using Accumulator = std::vector<std::uint16_t>;

/// Votes counted by angles in double: alpha = alpha_m - alpha_s, wrapped to [0, 2 pi).
template <class Keep>
Accumulator naive_accumulator(const Votes& v, Keep&& keep) {
  Accumulator accumulator(v.num_points * kRotationBins, 0);
  for (const SceneVote& vote : v.votes) {
    if (vote.cell >= v.quantization.num_cells() || !keep(vote.cell)) continue;
    for (std::uint32_t e = v.offsets[vote.cell]; e < v.offsets[vote.cell + 1]; ++e) {
      double alpha = (static_cast<double>(v.entries[e].angle) - vote.rotation) / 65536;
      if (alpha < 0) alpha += 1;
      const auto bin = static_cast<std::size_t>(alpha * kRotationBins);
      ++accumulator[v.entries[e].reference * kRotationBins + bin];
    }
  }
  return accumulator;
}

std::uint64_t sum(const Accumulator& accumulator) {
  std::uint64_t total = 0;
  for (const std::uint16_t count : accumulator) total += count;
  return total;
}

TEST(CastVotes, AgreesWithANaiveAccumulator) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Random random(trial);
    const Votes v(random);
    const Accumulator expected = naive_accumulator(v, [](auto) { return true; });
    Accumulator found(expected.size(), 0);
    EXPECT_EQ(cast_votes(v.votes, v.table(), kNoLimit, found), sum(expected));
    EXPECT_EQ(found, expected);
  }
}

TEST(CastVotes, SkipsCellsBeyondTheTable) {
  Random random;
  Votes v(random);
  for (std::size_t k = 0; k < 50; ++k) v.votes[k].cell += v.quantization.num_cells();
  v.sort();
  v.votes.push_back({0xFFFFFFFEU, 0});
  const Accumulator expected = naive_accumulator(v, [](auto) { return true; });
  Accumulator found(expected.size(), 0);
  EXPECT_EQ(cast_votes(v.votes, v.table(), kNoLimit, found), sum(expected));
  EXPECT_EQ(found, expected);
}

TEST(CastVotes, AddsUpOverChunksOfLookUps) {
  Random random;
  const Votes v(random);
  Accumulator whole(v.num_points * kRotationBins, 0), parts = whole;
  const std::uint64_t total = cast_votes(v.votes, v.table(), kNoLimit, whole);
  std::uint64_t in_parts = 0;
  test::for_chunks(v.votes.size(), 7, [&](std::size_t first, std::size_t count) {
    in_parts += cast_votes(std::span(v.votes).subspan(first, count), v.table(), kNoLimit, parts);
  });
  EXPECT_EQ(in_parts, total);
  EXPECT_EQ(parts, whole);
}

TEST(CastVotes, LeavesOutTheFullestCellsOnlyAndNoMoreThanNeeded) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Random random(trial);
    const Votes v(random);
    const auto smaller_than = [&](std::uint32_t limit) {
      return naive_accumulator(v, [&](std::uint32_t cell) { return v.cell_size(cell) < limit; });
    };
    const std::uint64_t all = sum(smaller_than(1000));
    for (const std::uint64_t budget :
         {std::uint64_t{0}, all / 20, all / 3, all - 1, all, 2 * all}) {
      // The limit is the largest power of two that keeps the sum over all cells within the budget.
      std::uint32_t limit = 1;
      while (limit < 64 && sum(smaller_than(2 * limit)) <= budget) limit *= 2;
      const Accumulator expected = smaller_than(limit);
      Accumulator found(expected.size(), 0);
      EXPECT_EQ(cast_votes(v.votes, v.table(), budget, found), sum(expected)) << budget;
      EXPECT_EQ(found, expected) << budget;
      EXPECT_LE(sum(found), budget);
    }
  }
}

/// Sums over three bins with wrap-around, the best of each row; rows sorted by votes, then number.
std::vector<VotePeak> naive_peaks(const Accumulator& accumulator, std::size_t max_peaks,
                                  double share) {
  std::vector<VotePeak> peaks;
  for (std::uint32_t row = 0; row < accumulator.size() / kRotationBins; ++row) {
    const auto at = [&](std::uint32_t bin) {
      return std::uint32_t{accumulator[row * kRotationBins + bin % kRotationBins]};
    };
    VotePeak best{row, 0, 0};
    for (std::uint32_t bin = 0; bin < kRotationBins; ++bin) {
      const std::uint32_t left = at(bin + kRotationBins - 1), right = at(bin + 1);
      const std::uint32_t votes = left + at(bin) + right;
      if (votes <= best.votes) continue;
      const double middle =
          ((bin - 0.5) * left + (bin + 0.5) * at(bin) + (bin + 1.5) * right) / votes;
      best = {row, static_cast<float>(middle * kBinRad), votes};
    }
    if (best.votes > 0) peaks.push_back(best);
  }
  std::ranges::stable_sort(peaks, std::ranges::greater{}, &VotePeak::votes);
  const double floor = peaks.empty() ? 0 : share * peaks.front().votes;
  std::erase_if(peaks, [&](const VotePeak& peak) { return peak.votes < floor; });
  peaks.resize(std::min(peaks.size(), max_peaks));
  return peaks;
}

// Small counts make ties among rows and bins common, and peaks at the seam likely.
TEST(ExtractPeaks, AgreesWithNaivePeaksAndLeavesZeros) {
  for (std::uint64_t trial = 0; trial < 300; ++trial) {
    Random random(trial);
    Accumulator accumulator((1 + random.below(30)) * kRotationBins, 0);
    const std::uint32_t most = 1 + random.below(12);
    for (auto& count : accumulator) {
      if (random.below(4) == 0) count = static_cast<std::uint16_t>(random.below(most));
    }
    const std::size_t max_peaks = 1 + random.below(kMaxPeaks);
    const float share = std::array{0.0F, 0.5F, 0.75F, 1.0F}[random.below(4)];
    const auto expected = naive_peaks(accumulator, max_peaks, static_cast<double>(share));
    const VotePeaks found = extract_peaks(accumulator, max_peaks, share);
    ASSERT_EQ(found.count, expected.size()) << trial;
    for (std::size_t k = 0; k < found.count; ++k) {
      EXPECT_EQ(found.peak[k].model_point, expected[k].model_point) << trial;
      EXPECT_EQ(found.peak[k].votes, expected[k].votes) << trial;
      EXPECT_NEAR(found.peak[k].rotation_rad, expected[k].rotation_rad, 1e-5) << trial;
    }
    EXPECT_EQ(sum(accumulator), 0U) << trial;
  }
}

TEST(ExtractPeaks, FindsNothingInAnEmptyAccumulator) {
  Accumulator accumulator(3 * kRotationBins, 0);
  EXPECT_EQ(extract_peaks(accumulator, kMaxPeaks, 0.5F).count, 0U);
  EXPECT_EQ(extract_peaks(std::span(accumulator).first(0), kMaxPeaks, 0.5F).count, 0U);
}

// The sum of three full counters exceeds 16 bits.
TEST(ExtractPeaks, SumsWithoutOverflow) {
  Accumulator accumulator(2 * kRotationBins, 0);
  for (const std::uint32_t bin : {31U, 32U, 62U, 63U})
    accumulator[bin] = 65535;  // row 1: 0, 30, 31
  const VotePeaks peaks = extract_peaks(accumulator, 2, 0);
  ASSERT_EQ(peaks.count, 2U);
  EXPECT_EQ(peaks.peak[0].model_point, 1U);
  EXPECT_EQ(peaks.peak[0].votes, 3U * 65535);
  EXPECT_NEAR(peaks.peak[0].rotation_rad, 31.5 * kBinRad, 1e-5);
  EXPECT_EQ(peaks.peak[1].votes, 65535U);
}

TEST(Voting, AllocatesNothing) {
  Random random;
  const Votes v(random);
  Accumulator accumulator(v.num_points * kRotationBins, 0);
  EXPECT_EQ(test::allocations_in([&] {
              cast_votes(v.votes, v.table(), 500, accumulator);
              extract_peaks(accumulator, kMaxPeaks, 0.5F);
            }),
            0U);
}

/// The table of all point pairs of a model.
struct Table {
  explicit Table(const OrientedCloud& model) : offsets(quantization.num_cells() + 1) {
    const std::size_t n = model.points.size();
    const PpfPoints points{model.points, model.normals, {}};
    PairScratch scratch(n);
    std::vector<std::uint32_t> counts(quantization.num_cells(), 0);
    count_ppf_pairs({points, quantization, 0, n}, scratch, counts);
    entries.resize(scan_ppf_counts(counts, 1, offsets));
    fill_ppf_entries({points, quantization, 0, n}, scratch, counts, entries);
  }
  PpfTableView view() const {
    return {.quantization = quantization, .offsets = offsets, .entries = entries};
  }
  PpfQuantization quantization{0.2F, 18, 12};
  std::vector<std::uint32_t> offsets;
  std::vector<PpfEntry> entries;
};

// End to end: each point of a moved copy finds its model point, and the motion to within a bin.
TEST(Voting, FindsTheMotionOfACopy) {
  for (std::uint64_t trial = 0; trial < 5; ++trial) {
    Random random(trial);
    const OrientedCloud model = test::random_oriented(random, 100);
    const Pose truth = random.motion();
    const OrientedCloud scene = test::moved(model, truth);
    const Table table(model);
    PairScratch scratch(100);
    VoteKeys keys;
    std::vector<SceneVote> votes;
    Accumulator accumulator(100 * kRotationBins, 0);
    for (std::uint32_t r = 0; r < 100; r += 10) {
      const ReferenceFrame frame = reference_frame(scene.points[r], scene.normals[r]);
      collect_scene_votes(frame, {scene.points, scene.normals}, {table.quantization, 0.2F}, scratch,
                          keys, votes);
      cast_votes(votes, table.view(), kNoLimit, accumulator);
      const VotePeak peak = extract_peaks(accumulator, 1, 0.5F).peak[0];
      ASSERT_EQ(peak.model_point, r);
      EXPECT_GE(peak.votes, 95U);  // its 99 pairs, less those that rounding moves elsewhere
      Pose turn = Pose::Identity();
      turn.linear() = Eigen::AngleAxisf(peak.rotation_rad, Vector3f::UnitX()).toRotationMatrix();
      const Pose found = frame_pose(frame).inverse() * turn *
                         frame_pose(reference_frame(model.points[r], model.normals[r]));
      EXPECT_LT(reference::rotation_angle(found, truth), kBinRad);
      EXPECT_LT((found * model.points[r] - scene.points[r]).norm(), 1e-5);
    }
  }
}

}  // namespace
}  // namespace trivet::kernels
