/// The conclusion of an experiment in a sentence.
#pragma once

#include <string>

#include "apps/study/results.hpp"

namespace trivet::apps::study {

/// The numbers over all scenes that answer the question of the experiment, as HTML.
std::string headline(const ExperimentResults& results);

}  // namespace trivet::apps::study
