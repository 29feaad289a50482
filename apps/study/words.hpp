/// What the numbers of a study say, in sentences.
#pragma once

#include <string>
#include <vector>

#include "apps/study/results.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps {

/// "97.2 %".
std::string percent(double share);

/// "97.2 % (94.1 to 98.7)".
std::string rate_text(const Rate& rate);

/// "+1.2 points (0.3 to 2.1, p 0.012)".
std::string difference_text(const PairedComparison& comparison);

/// Whether chance alone explains a difference badly: McNemar's p below 0.05, and an interval that
/// leaves 0 out.
bool beyond_chance(const PairedComparison& comparison);

/// Sentences as HTML; the first of them is the most important.
std::vector<std::string> findings(const Experiment& experiment, const ExperimentResults& results);

}  // namespace trivet::apps
