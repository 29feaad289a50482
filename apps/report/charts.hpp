/// The charts of the report as inline SVG; their colors are those of the page.
#pragma once

#include <string>

#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// Precision over recall, with the reported point and the point of the best F1.
std::string precision_recall_chart(const Evaluation& evaluation);

/// The fraction of correct detections over their score, with 95 % intervals and counts.
std::string calibration_chart(const Calibration& calibration);

}  // namespace trivet::apps
