/// Quality of detection scores: precision and recall over a threshold, calibration.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace trivet {

/// Score of a detection that counts, and whether it found a truth that counts.
struct ScoredOutcome {
  double score = 0;
  bool right = false;
};

/// Result of reporting the detections from one score on.
struct OperatingPoint {
  double score = 0;
  double precision = 0, recall = 0;
  double f1() const noexcept;  ///< harmonic mean of precision and recall; 0 if both are 0
};

struct PrecisionRecall {
  std::vector<OperatingPoint> points;  ///< one per distinct score, falling
  /// Area below the curve, with the best precision at each recall or above. Source: Everingham et
  /// al., IJCV 2015 (PASCAL VOC), at every recall.
  double average_precision = 0;
  /// Point with the highest F1; for equal values, the one with the highest score.
  std::optional<OperatingPoint> best_f1;
};

/// instances  number of truths that could be found; if 0, every recall is 0
/// Cost: n log n.
PrecisionRecall precision_recall(std::span<const ScoredOutcome> outcomes, std::size_t instances);

struct CalibrationBin {
  /// Range of the score; a score of `high` belongs to the next bin, except 1.
  double low = 0, high = 0;
  std::size_t right = 0, all = 0;
  double mean_score = 0;  ///< 0 without detections
};

/// How well a score predicts the probability of being correct.
struct Calibration {
  std::vector<CalibrationBin> bins;  ///< ten bins of equal width over 0 to 1
  /// Mean difference between a bin's mean score and its share of correct detections, weighted by
  /// the bins' detections. Source: Guo et al., ICML 2017.
  double expected_error = 0;
};

/// Calibration of scores. Absent without detections, and if a score lies outside 0 to 1, as it is
/// not a probability then.
std::optional<Calibration> calibrate(std::span<const ScoredOutcome> outcomes);

/// The 95 % confidence interval of the true rate, given the successes of independent trials. The
/// whole range without trials. Source: Wilson, JASA 1927.
std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) noexcept;

}  // namespace trivet
