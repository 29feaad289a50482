/// The curves of a study's report, as SVG within the page.
#pragma once

#include <string>

#include "apps/study/results.hpp"

namespace trivet::apps::study {

/// The share found, with Wilson intervals: a curve over a quantity, else a row for each name.
std::string rate_chart(const Panel& panel);

/// Seconds of a scene on one core; empty where they are not known, and for bins of truths.
std::string time_chart(const Panel& panel);

/// What the colors mean.
std::string chart_key(const Panel& panel);

}  // namespace trivet::apps::study
