/// Which of two methods finds more of the same things, and how sure that is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace trivet {

/// Trials that both methods had, by who succeeded: for example the instances of one scene.
struct PairedTrials {
  std::size_t both = 0, only_first = 0, only_second = 0, neither = 0;

  std::size_t num_trials() const noexcept { return both + only_first + only_second + neither; }
  PairedTrials& operator+=(const PairedTrials& other) noexcept;
  bool operator==(const PairedTrials&) const = default;
};

struct PairedComparison {
  PairedTrials total;
  double difference = 0;     ///< rate of the first less that of the second; 0 without trials
  double low = 0, high = 0;  ///< of the difference, with a confidence of 95 %
  double p = 1;              ///< of a difference at least as large where both are equally good
  bool operator==(const PairedComparison&) const = default;
};

/// Compare two methods on the same trials.
///
/// scenes  trials of each scene, which may depend on one another; scenes do not
/// seed    of the resampling
/// The interval is the percentile bootstrap over scenes: 2,000 times as many scenes are drawn with
/// replacement, and their trials pooled. It needs some tens of scenes; one scene alone has nothing
/// that varies. p is McNemar's exact two-sided test on the trials where just one method succeeded;
/// it takes trials for independent, so where those of a scene succeed together, trust the interval.
/// Same bytes for the same input. Cost: 2,000 scenes.size().
/// Source: McNemar, Psychometrika 1947; Efron and Tibshirani, An Introduction to the Bootstrap,
/// 1993, chapter 13.
PairedComparison compare_paired(std::span<const PairedTrials> scenes, std::uint64_t seed);

}  // namespace trivet
