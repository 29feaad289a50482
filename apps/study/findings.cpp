#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>

#include "apps/options/option_names.hpp"
#include "apps/report/html.hpp"
#include "apps/study/phrases.hpp"
#include "apps/study/words.hpp"

namespace trivet::apps::study {
namespace {

constexpr double kHeld = 0.9;  // of what is found under the first condition
constexpr std::size_t kMostNamed = 6;

// A parameter: where the default lies.

/// The row with the best F1; the default unless another is better.
std::size_t best_row(const Panel& panel, std::size_t m) {
  std::size_t best = panel.reference_row;
  for (std::size_t row = 0; row < panel.rows.size(); ++row) {
    if (panel.cells[m][row].f1 > panel.cells[m][best].f1) best = row;
  }
  return best;
}

std::string on_parameter(const Experiment& experiment, const Panel& panel, std::size_t m) {
  const std::vector<PanelCell>& cells = panel.cells[m];
  const std::size_t usual = panel.reference_row, best = best_row(panel, m);
  std::string out = panel_prefix(experiment, panel) + option_name(panel.methods[m]) + " finds " +
                    rate_text(cells[usual].found) + " at the default, " +
                    escape_html(panel.rows[usual]) + ", with " +
                    alarms_text(*cells[usual].false_positives) + ", in " +
                    seconds_text(cells[usual]) + ". ";
  if (best == usual) {
    out += "No other value has a better F1.";
  } else {
    const std::optional<PairedComparison>& change = cells[best].change;
    out += fmt::format("The best F1 is at {} ({}, {}, {})", escape_html(panel.rows[best]),
                       percent(cells[best].found.value()),
                       alarms_text(*cells[best].false_positives), seconds_text(cells[best]));
    if (change) {
      out += fmt::format(
          ": {}, {}", difference_text(*change),
          beyond_chance(*change) ? "more than chance explains" : "which chance explains");
    }
    out += ".";
  }
  const auto [better, worse] = differing_rows(cells, &PanelCell::change);
  if (!worse.empty()) out += " Beyond chance fewer are found at " + rows_text(panel, worse) + ".";
  if (!better.empty()) out += " Beyond chance more are found at " + rows_text(panel, better) + ".";
  if (worse.empty() && better.empty()) out += " No value differs from the default beyond chance.";
  return out;
}

// Conditions: which method bears them.

std::string on_methods(const Panel& panel) {
  std::vector<std::string> rates, leads;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    rates.push_back(fmt::format("{} {} with {}", option_name(panel.methods[m]),
                                percent(sum_found(panel.cells[m]).value()),
                                alarms_text(sum_false(panel.cells[m]))));
    if (panel.leads[m]) {
      leads.push_back(fmt::format("{} against {}: {}", option_name(panel.methods[m]),
                                  option_name(panel.methods[0]), difference_text(*panel.leads[m])));
    }
  }
  std::string out = fmt::format("Over all, {}", fmt::join(rates, ", "));
  if (!leads.empty()) out += fmt::format("; {}", fmt::join(leads, "; "));
  return out + ".";
}

/// Up to which row a method finds most of what it finds in the first.
std::string on_bearing(const Panel& panel) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const double first = panel.cells[m].front().found.value();
    std::size_t last = 0;
    while (last + 1 < panel.rows.size() &&
           panel.cells[m][last + 1].found.value() >= kHeld * first) {
      ++last;
    }
    parts.push_back(fmt::format("{} up to {} ({})", option_name(panel.methods[m]),
                                escape_html(panel.rows[last]),
                                percent(panel.cells[m][last].found.value())));
  }
  return fmt::format("Nine tenths of what is found at {} are still found by {}.",
                     escape_html(panel.rows.front()), fmt::join(parts, ", by "));
}

std::string on_leads(const Panel& panel) {
  std::string out;
  for (std::size_t m = 1; m < panel.methods.size(); ++m) {
    const auto [ahead, behind] = differing_rows(panel.cells[m], &PanelCell::lead);
    for (const auto& [rows, word] : {std::pair{&ahead, "more"}, {&behind, "fewer"}}) {
      if (rows->empty()) continue;
      out += fmt::format(" Beyond chance {} finds {} than {} at {}.", option_name(panel.methods[m]),
                         word, option_name(panel.methods[0]), rows_text(panel, *rows));
    }
  }
  return out;
}

std::string on_times(const Panel& panel) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    parts.push_back(
        fmt::format("{} {} at {} and {} at {}", option_name(panel.methods[m]),
                    seconds_text(panel.cells[m].front()), escape_html(panel.rows.front()),
                    seconds_text(panel.cells[m].back()), escape_html(panel.rows.back())));
  }
  return fmt::format(" A scene takes {}.", fmt::join(parts, ", "));
}

std::string on_conditions(const Experiment& experiment, const Panel& panel) {
  std::string out = panel_prefix(experiment, panel) + on_methods(panel);
  if (panel.is_curve) out += " " + on_bearing(panel);
  out += on_leads(panel);
  return panel.is_curve ? out + on_times(panel) : out;
}

// Steps: what each adds.

std::string on_steps(const Experiment& experiment, const Panel& panel, std::size_t m) {
  const std::vector<PanelCell>& cells = panel.cells[m];
  const PanelCell &first = cells.front(), &last = cells.back();
  std::string out =
      panel_prefix(experiment, panel) +
      fmt::format(
          "From {} to {}, what is found goes from {} to {}, false alarms from {} to {}, "
          "F1 from {:.3f} to {:.3f}, a scene from {} to {}.",
          escape_html(panel.rows.front()), escape_html(panel.rows.back()), rate_text(first.found),
          rate_text(last.found), first.false_positives.value_or(0),
          last.false_positives.value_or(0), first.f1, last.f1, seconds_text(first),
          seconds_text(last));
  std::vector<std::size_t> order;
  for (std::size_t row = 1; row < cells.size(); ++row) order.push_back(row);
  std::ranges::stable_sort(order, std::greater<>{},
                           [&](std::size_t row) { return cells[row].f1 - cells[row - 1].f1; });
  std::vector<std::string> steps;
  for (const std::size_t row : order) {
    const double gain = cells[row].f1 - cells[row - 1].f1;
    if (gain < 0.005 || steps.size() == kMostNamed) break;
    steps.push_back(fmt::format("{} ({:+.3f})", escape_html(panel.rows[row]), gain));
  }
  if (!steps.empty()) out += fmt::format(" The largest gains in F1: {}.", fmt::join(steps, ", "));
  return out;
}

// Bins of truths.

std::string on_bins(const Experiment& experiment, const Panel& panel) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& all = panel.cells[m].back();
    const std::size_t num_false = all.false_positives.value_or(0);
    std::string part = option_name(panel.methods[m]) + " finds ";
    if (const std::optional<Rate> below = found_below_84(panel, m)) {
      part += fmt::format("{} of the {} instances less than 84 % occluded, ", rate_text(*below),
                          below->all);
    }
    const double share = num_false == 0 ? 0
                                        : static_cast<double>(num_false) /
                                              static_cast<double>(all.found.right + num_false);
    part += fmt::format("{} of all {}, with {} ({} of what it reports)", rate_text(all.found),
                        all.found.all, alarms_text(num_false), percent(share));
    if (all.lead) {
      part += fmt::format("; against {}: {}", option_name(panel.methods[0]),
                          difference_text(*all.lead));
    }
    parts.push_back(std::move(part));
  }
  return fmt::format("{}In {}, {}.", panel_prefix(experiment, panel),
                     counted(panel.cells[0].back().num_scenes, "scene", "scenes"),
                     fmt::join(parts, ". "));
}

// Kinds of scenes.

std::string on_row(const Panel& panel, std::size_t row) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& cell = panel.cells[m][row];
    std::string part =
        fmt::format("{} {}, {}, {}", option_name(panel.methods[m]), rate_text(cell.found),
                    alarms_text(*cell.false_positives), seconds_text(cell));
    if (cell.lead) {
      part += fmt::format(" (against {}: {})", option_name(panel.methods[0]),
                          difference_text(*cell.lead));
    }
    parts.push_back(std::move(part));
  }
  return fmt::format("<b>{}</b>: {}.", escape_html(panel.rows[row]), fmt::join(parts, "; "));
}

}  // namespace

std::vector<std::string> findings(const Experiment& experiment, const ExperimentResults& results) {
  std::vector<std::string> out;
  for (const Panel& panel : results.panels) {
    switch (results.kind) {
      case ExperimentKind::bins:
        out.push_back(on_bins(experiment, panel));
        break;
      case ExperimentKind::groups:
        for (std::size_t row = 0; row < panel.rows.size(); ++row) out.push_back(on_row(panel, row));
        break;
      case ExperimentKind::steps:
        for (std::size_t m = 0; m < panel.methods.size(); ++m)
          out.push_back(on_steps(experiment, panel, m));
        break;
      case ExperimentKind::parameter:
        for (std::size_t m = 0; m < panel.methods.size(); ++m)
          out.push_back(on_parameter(experiment, panel, m));
        break;
      case ExperimentKind::conditions:
        out.push_back(on_conditions(experiment, panel));
        break;
    }
  }
  return out;
}

}  // namespace trivet::apps::study
