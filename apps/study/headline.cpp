#include "apps/study/headline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>
#include <string_view>
#include <vector>

#include "apps/report/html.hpp"

namespace trivet::apps::study {
namespace {

constexpr std::string_view kStronglyOccluded = ">84%";

/// Sums over some cells of a method.
struct Sum {
  Rate found;
  std::size_t num_false = 0;

  void add(const PanelCell& cell) {
    found.right += cell.found.right;
    found.all += cell.found.all;
    num_false += cell.false_positives.value_or(0);
  }
  std::string share() const { return percent(found.value()); }
  double f1() const { return f1_score(found, num_false); }
};

/// Sums over one row of each panel, which `row_of` chooses.
template <class RowOf>
Sum sum_row(const ExperimentResults& results, std::size_t m, RowOf&& row_of) {
  Sum sum;
  for (const Panel& panel : results.panels) sum.add(panel.cells[m][row_of(panel)]);
  return sum;
}

std::size_t first_row(const Panel&) { return 0; }
std::size_t last_row(const Panel& panel) { return panel.rows.size() - 1; }
std::size_t usual_row(const Panel& panel) { return panel.reference_row; }

/// A text about each method, such as "ppf finds ..., trisi ...".
template <class Text>
std::string by_methods(const ExperimentResults& results, Text&& text) {
  const std::vector<Method>& methods = results.panels.front().methods;
  std::string out;
  for (std::size_t m = 0; m < methods.size(); ++m)
    out += fmt::format("{}{} {}{}", m > 0 ? ", " : "", choice_name(methods[m]),
                       m > 0 ? "" : "finds ", text(m));
  return out;
}

/// The names of rows: "0.02", or for a curve "0.02 to 0.05" for adjacent rows.
std::string row_names(const Panel& panel, const std::set<std::size_t>& rows) {
  std::vector<std::string> names;
  for (auto row = rows.begin(); row != rows.end(); ++row) {
    const std::size_t first = *row;
    while (panel.is_curve && std::next(row) != rows.end() && *std::next(row) == *row + 1) ++row;
    names.push_back(escape_html(panel.rows[first]));
    if (*row > first)
      names.back() += (*row > first + 1 ? " to " : ", ") + escape_html(panel.rows[*row]);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

// One function for each kind of experiment.

std::string on_bins(const ExperimentResults& results) {
  const Panel& panel = results.panels.front();  // the panel of all scenes
  const auto strong = std::ranges::find(panel.rows, kStronglyOccluded);
  const bool is_occlusion = strong != panel.rows.end();
  return by_methods(results,
                    [&](std::size_t m) {
                      const std::vector<PanelCell>& cells = panel.cells[m];
                      if (!is_occlusion) return percent(cells.back().found.value());
                      Sum sum;
                      for (auto row = panel.rows.begin(); row != strong; ++row)
                        sum.add(cells[static_cast<std::size_t>(row - panel.rows.begin())]);
                      return sum.share();
                    }) +
         (is_occlusion ? " of what is less than 84 % occluded" : "");
}

std::string on_all(const ExperimentResults& results) {
  return by_methods(results, [&](std::size_t m) {
    Sum sum;
    for (const Panel& panel : results.panels) {
      for (const PanelCell& cell : panel.cells[m]) sum.add(cell);
    }
    return sum.share();
  });
}

std::string on_conditions(const ExperimentResults& results) {
  const Panel& panel = results.panels.front();
  if (!panel.is_curve) return on_all(results);
  return by_methods(results, [&](std::size_t m) {
    return fmt::format("{} at {} and {} at {}", sum_row(results, m, first_row).share(),
                       escape_html(panel.rows.front()), sum_row(results, m, last_row).share(),
                       escape_html(panel.rows.back()));
  });
}

std::string on_steps(const ExperimentResults& results) {
  const Panel& panel = results.panels.front();
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    parts.push_back(fmt::format("{:.2f} to {:.2f} by {}", sum_row(results, m, first_row).f1(),
                                sum_row(results, m, last_row).f1(), choice_name(panel.methods[m])));
  }
  return fmt::format("from {} to {}, F1 goes from {}", escape_html(panel.rows.front()),
                     escape_html(panel.rows.back()), fmt::join(parts, ", "));
}

std::string on_parameter(const ExperimentResults& results) {
  std::set<std::size_t> more, fewer;
  for (const Panel& panel : results.panels) {
    for (const std::vector<PanelCell>& cells : panel.cells) {
      for (std::size_t row = 0; row < cells.size(); ++row) {
        const std::optional<PairedComparison>& change = cells[row].change;
        if (change && beyond_chance(*change)) (change->difference > 0 ? more : fewer).insert(row);
      }
    }
  }
  const Panel& panel = results.panels.front();
  std::string out =
      by_methods(results, [&](std::size_t m) { return sum_row(results, m, usual_row).share(); });
  out += " at the default, " + escape_html(panel.rows[panel.reference_row]);
  if (more.empty() && fewer.empty()) return out + "; no value differs beyond chance";
  out += "; beyond chance ";
  if (!more.empty()) out += "more at " + row_names(panel, more);
  if (!fewer.empty()) out += (more.empty() ? "fewer at " : ", fewer at ") + row_names(panel, fewer);
  return out;
}

}  // namespace

std::string headline(const ExperimentResults& results) {
  switch (results.kind) {
    case ExperimentKind::bins:
      return on_bins(results) + ".";
    case ExperimentKind::groups:
      return on_all(results) + ".";
    case ExperimentKind::steps:
      return on_steps(results) + ".";
    case ExperimentKind::parameter:
      return on_parameter(results) + ".";
    case ExperimentKind::conditions:
      return on_conditions(results) + ".";
  }
  return "";
}

}  // namespace trivet::apps::study
