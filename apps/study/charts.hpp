/// The charts of a study's report, as inline SVG.
#pragma once

#include <string>

#include "apps/study/results.hpp"

namespace trivet::apps::study {

/// The found fraction with Wilson intervals: a curve over a quantity, else one row per name.
std::string rate_chart(const Panel& panel);

/// Seconds per scene on one core; empty if unknown, and for bins of truths.
std::string time_chart(const Panel& panel);

/// The legend of the colors.
std::string chart_key(const Panel& panel);

}  // namespace trivet::apps::study
