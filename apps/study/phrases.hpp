/// Numbers of a study in words, for headlines and findings alike. All text is HTML.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/results.hpp"
#include "apps/study/study.hpp"

namespace trivet::apps::study {

/// "97.2 % (94.1 to 98.7)".
std::string rate_text(const Rate& rate);

/// A difference of shares in points, with its sign: "+1.2", "−0.3", "0.0".
std::string points_text(double difference);

/// "+1.2 points (+0.3 to +2.1, p 0.012)".
std::string difference_text(const PairedComparison& comparison);

/// "0.31 s".
std::string seconds_text(const PanelCell& cell);

/// "no false alarm", "3 false alarms".
std::string alarms_text(std::size_t num_false);

/// "0.02", or of a curve "0.02 to 0.05" for rows side by side; commas between.
std::string rows_text(const Panel& panel, const std::vector<std::size_t>& rows);

/// The panel's title before a sentence about it, where an experiment has several.
std::string panel_prefix(const Experiment& experiment, const Panel& panel);

/// Whether chance alone explains a difference badly: McNemar's p below 0.05, and an interval that
/// leaves 0 out.
bool beyond_chance(const PairedComparison& comparison);

/// Rows that differ beyond chance from what they are compared with.
struct DifferingRows {
  std::vector<std::size_t> better, worse;
};
DifferingRows differing_rows(const std::vector<PanelCell>& cells,
                             std::optional<PairedComparison> PanelCell::*comparison);

/// All rows of a method together.
Rate sum_found(const std::vector<PanelCell>& cells);
std::size_t sum_false(const std::vector<PanelCell>& cells);

/// Of a panel by occlusion: the truths that are less than 84 % occluded. None where it has no bin
/// of those that are more.
std::optional<Rate> found_below_84(const Panel& panel, std::size_t method);

}  // namespace trivet::apps::study
