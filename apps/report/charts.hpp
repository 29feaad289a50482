/// The curves of the report as inline SVG; their colors are those of the page.
#pragma once

#include <string>

#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// Precision over recall, with the point that was reported and the one of the best F1.
std::string precision_recall_chart(const Evaluation& evaluation);

/// The share of right detections over their score, with 95 % intervals and numbers.
std::string calibration_chart(const Calibration& calibration);

}  // namespace trivet::apps
