/// Adaptation of the score to the scans of one cell, no further than those scans support.
#pragma once

#include <cstddef>

#include "engine/calibration/calibrate_score.hpp"
#include "kernels/scoring/adapt_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// kLeastMarks correct outcomes, and as many wrong ones.
inline constexpr std::size_t kLeastScans = 2, kLeastMarks = 3;

/// Quality of a score on outcomes.
struct ScoreTally {
  std::size_t right = 0, wrong = 0;  ///< numbers of outcomes that reach the minimum score
  double log_loss = 0;               ///< mean; lower is better
};

struct Commissioning {
  kernels::ScoreAdaptation adaptation;  ///< fit to all scans; empty if it does not help
  float share = 0;  ///< share of the step to the most probable adaptation; 0: no step
  /// After: each scan with the adaptation from the others, with the same share.
  ScoreTally before, after;
  std::size_t num_right = 0, num_wrong = 0;
  // Outcomes of scans left out that cross the minimum score.
  std::size_t right_gained = 0, right_lost = 0, wrong_lost = 0;

  bool helps() const noexcept { return share > 0; }
};

/// Fit an adaptation to all scans, and apply the share of it that is best for scans left out of the
/// fit. This is the share with the smallest log loss. Shares are excluded if they raise a wrong
/// outcome over the minimum score, or if they do not pay off there. A share pays off if it loses no
/// more correct outcomes than least / (1 - least) for each wrong one removed, which is the ratio
/// that the threshold implies.
///
/// model      current model for scoring the outcomes' parts
/// least      minimum score of reported detections, 0.5 to below 1
/// Errors: bad_data (fewer than kLeastScans scans, or than kLeastMarks correct or wrong outcomes;
/// the correct ones have lower scores than the wrong ones).
Result<Commissioning> commission_score(const kernels::ScoreModel& model, const Outcomes& outcomes,
                                       float least);

}  // namespace trivet
