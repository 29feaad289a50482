/// What the scores of detections are worth: precision and recall over a threshold, calibration.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace trivet {

/// A detection that counts: its score, and whether it found a truth that counts.
struct ScoredOutcome {
  double score = 0;
  bool right = false;
};

/// What is reached by reporting the detections from one score on.
struct OperatingPoint {
  double score = 0;
  double precision = 0, recall = 0;
  double f1() const noexcept;  ///< harmonic mean of precision and recall; 0 if both are
};

struct PrecisionRecall {
  std::vector<OperatingPoint> points;  ///< one a score that occurs, falling
  /// Area below the curve, where each recall is given the best precision of any recall at least as
  /// high. Source: Everingham et al., IJCV 2015 (PASCAL VOC), at every recall.
  double average_precision = 0;
  std::optional<OperatingPoint> best_f1;  ///< of equal ones that of the highest score
};

/// instances  truths that could be found; without any, every recall is 0
/// Cost: n log n.
PrecisionRecall precision_recall(std::span<const ScoredOutcome> outcomes, std::size_t instances);

struct CalibrationBin {
  double low = 0, high = 0;  ///< of the score; a score of `high` belongs to the next bin, save 1
  std::size_t right = 0, all = 0;
  double mean_score = 0;  ///< 0 without detections
};

/// How well a score tells the probability of being right.
struct Calibration {
  std::vector<CalibrationBin> bins;  ///< ten of equal width over 0 to 1
  /// Mean distance between a bin's mean score and its share of right ones, weighed by the bins'
  /// detections. Source: Guo et al., ICML 2017.
  double expected_error = 0;
};

/// None without detections, and none if a score lies outside 0 to 1, as it is no probability then.
std::optional<Calibration> calibrate(std::span<const ScoredOutcome> outcomes);

/// The range that holds the true rate with a confidence of 95 %, given the successes of independent
/// trials. Whole range without trials. Source: Wilson, JASA 1927.
std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) noexcept;

}  // namespace trivet
