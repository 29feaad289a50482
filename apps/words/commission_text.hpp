/// The effect of a calibration of the score, in words.
#pragma once

#include <string>

#include "engine/calibration/commission_score.hpp"

namespace trivet::apps {

/// The marks, the scores of held-out scans before and after, the parts with changed weights, and
/// how reliable the calibration is.
std::string commission_text(const Commissioning& found, const Outcomes& outcomes, float least);

/// The marks that contradict the score most, one line each; empty if none does. Incomplete truth
/// shows here, as detections marked wrong that are surely right.
std::string doubtful_marks(const kernels::ScoreModel& model, const Outcomes& outcomes);

}  // namespace trivet::apps
