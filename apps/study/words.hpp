/// What an experiment says, in sentences drawn from its numbers. All text is HTML.
#pragma once

#include <string>
#include <vector>

#include "apps/study/results.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// In short, for the top of the report.
std::string headline(const Experiment& experiment, const ExperimentResults& results);

/// With intervals, false alarms and times, a paragraph each.
std::vector<std::string> findings(const Experiment& experiment, const ExperimentResults& results);

}  // namespace trivet::apps::study
