/// What an experiment says, in a sentence.
#pragma once

#include <string>

#include "apps/study/results.hpp"

namespace trivet::apps::study {

/// The numbers of all scenes together that answer what the experiment asks, as HTML.
std::string headline(const ExperimentResults& results);

}  // namespace trivet::apps::study
