/// Paired comparison of two methods, with its statistical certainty.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace trivet {

/// Trials of both methods by their successes, for example on the instances of one scene.
struct PairedTrials {
  std::size_t both = 0, only_first = 0, only_second = 0, neither = 0;

  std::size_t num_trials() const noexcept { return both + only_first + only_second + neither; }
  PairedTrials& operator+=(const PairedTrials& other) noexcept;
  bool operator==(const PairedTrials&) const = default;
};

struct PairedComparison {
  PairedTrials total;
  double difference = 0;     ///< rate of the first minus that of the second; 0 without trials
  double low = 0, high = 0;  ///< 95 % confidence interval of the difference
  double p = 1;  ///< probability of a difference at least as large if both are equally good
  bool operator==(const PairedComparison&) const = default;
};

/// Compare two methods on the same trials.
///
/// scenes  trials of each scene; trials within a scene may be dependent, scenes are independent
/// seed    seed of the resampling
/// The interval is the percentile bootstrap over scenes: the scenes are resampled with replacement
/// 2,000 times, and their trials pooled. It needs some tens of scenes; a single scene has no
/// variation. p is McNemar's exact two-sided test on the trials where exactly one method succeeded.
/// It assumes independent trials, so prefer the interval if trials of a scene succeed together.
/// Same bytes for the same input. Cost: 2,000 scenes.size().
/// Source: McNemar, Psychometrika 1947; Efron and Tibshirani, An Introduction to the Bootstrap,
/// 1993, chapter 13.
PairedComparison compare_paired(std::span<const PairedTrials> scenes, std::uint64_t seed);

}  // namespace trivet
