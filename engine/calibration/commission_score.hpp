/// Adapt the score to the scans of one cell, no further than those scans support.
#pragma once

#include <cstddef>

#include "engine/calibration/calibrate_score.hpp"
#include "kernels/verification/adapt_score.hpp"
#include "storage/common/result.hpp"

namespace trivet {

inline constexpr std::size_t kLeastScans = 2, kLeastMarks = 3;  ///< kLeastMarks right, and wrong

/// What a score makes of outcomes.
struct ScoreTally {
  std::size_t right = 0, wrong = 0;  ///< that reach the least score
  double log_loss = 0;               ///< mean; the smaller the better
};

struct Commissioning {
  kernels::ScoreAdaptation adaptation;  ///< from all scans; none where it does not help
  float share = 0;           ///< of the way to the most probable adaptation that was gone; 0: none
  ScoreTally before, after;  ///< after: each scan by the adaptation from the others, as far gone
  std::size_t num_right = 0, num_wrong = 0;
  // Outcomes of scans left out that cross the least score.
  std::size_t right_gained = 0, right_lost = 0, wrong_lost = 0;

  bool helps() const noexcept { return share > 0; }
};

/// Fit an adaptation to all scans, and go as far towards it as is best for each scan when it is
/// left out: the smallest log loss, among steps that let no wrong outcome rise over the least score
/// and that are worth it there. What is worth it loses no more than least / (1 - least) wrong ones
/// less would make up for, in right ones: that is what the threshold says.
///
/// model      that the outcomes' parts are scored by now
/// least      score from which detections are reported, 0.5 to below 1
/// Errors: bad_data (fewer than kLeastScans scans, than kLeastMarks right or wrong outcomes; the
/// right ones have lower scores than the wrong ones).
Result<Commissioning> commission_score(const kernels::ScoreModel& model, const Outcomes& outcomes,
                                       float least);

}  // namespace trivet
