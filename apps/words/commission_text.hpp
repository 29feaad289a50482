/// What a calibration of the score changed, in words.
#pragma once

#include <string>

#include "engine/calibration/commission_score.hpp"

namespace trivet::apps {

/// The marks, what the scores of scans left out were and are, which parts count for more or less,
/// and how far to believe it.
std::string commission_text(const Commissioning& found, const Outcomes& outcomes, float least);

/// The marks that contradict the score most, a line each; empty where none does. Truth that is
/// incomplete shows here, as detections marked wrong that are surely right.
std::string doubtful_marks(const kernels::ScoreModel& model, const Outcomes& outcomes);

}  // namespace trivet::apps
