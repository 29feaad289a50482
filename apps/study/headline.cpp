#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/options/option_names.hpp"
#include "apps/report/html.hpp"
#include "apps/study/phrases.hpp"
#include "apps/study/words.hpp"

namespace trivet::apps::study {
namespace {

std::string on_parameter(const Panel& panel, std::size_t m) {
  const std::vector<PanelCell>& cells = panel.cells[m];
  std::string out = fmt::format("{} finds {} at the default, {}", option_name(panel.methods[m]),
                                percent(cells[panel.reference_row].found.value()),
                                escape_html(panel.rows[panel.reference_row]));
  const auto [better, worse] = differing_rows(cells, &PanelCell::change);
  if (!better.empty()) out += "; more at " + rows_text(panel, better);
  if (!worse.empty()) out += "; fewer at " + rows_text(panel, worse);
  return out + (better.empty() && worse.empty() ? "; no value differs beyond chance." : ".");
}

std::string on_conditions(const Panel& panel) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const std::vector<PanelCell>& cells = panel.cells[m];
    std::string part = option_name(panel.methods[m]) + " " + percent(sum_found(cells).value());
    if (panel.is_curve) {
      part += fmt::format(" ({} at {}, {} at {})", percent(cells.front().found.value()),
                          escape_html(panel.rows.front()), percent(cells.back().found.value()),
                          escape_html(panel.rows.back()));
    }
    parts.push_back(std::move(part));
  }
  std::string out = fmt::format("{}.", fmt::join(parts, ", "));
  if (!panel.is_curve) {
    std::vector<std::string> rows;
    for (std::size_t row = 0; row < panel.rows.size(); ++row) {
      rows.push_back(fmt::format("{} {}", escape_html(panel.rows[row]),
                                 percent(panel.cells.back()[row].found.value())));
    }
    out += fmt::format(" {} by {}: {}.", option_name(panel.methods.back()), escape_html(panel.axis),
                       fmt::join(rows, ", "));
  }
  for (std::size_t m = 1; m < panel.methods.size(); ++m) {
    const std::optional<PairedComparison>& lead = panel.leads[m];
    if (lead && beyond_chance(*lead)) {
      out += fmt::format(" Beyond chance {} finds {} than {}.", option_name(panel.methods[m]),
                         lead->difference > 0 ? "more" : "fewer", option_name(panel.methods[0]));
    }
  }
  return out;
}

std::string on_steps(const Panel& panel, std::size_t m) {
  const PanelCell &first = panel.cells[m].front(), &last = panel.cells[m].back();
  return fmt::format("from {} to {}, F1 {:.2f} becomes {:.2f}: {} found with {}, then {} with {}.",
                     escape_html(panel.rows.front()), escape_html(panel.rows.back()), first.f1,
                     last.f1, percent(first.found.value()), alarms_text(*first.false_positives),
                     percent(last.found.value()), alarms_text(*last.false_positives));
}

std::string on_bins(const Panel& panel) {
  std::vector<std::string> parts;
  bool below_84 = false;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& all = panel.cells[m].back();
    const std::optional<Rate> below = found_below_84(panel, m);
    below_84 = below.has_value();
    parts.push_back(fmt::format("{} {} with {}", option_name(panel.methods[m]),
                                rate_text(below.value_or(all.found)),
                                alarms_text(*all.false_positives)));
  }
  return fmt::format("{}in {}, {}.", below_84 ? "of what is less than 84 % occluded, " : "",
                     counted(panel.cells[0].back().num_scenes, "scene", "scenes"),
                     fmt::join(parts, ", "));
}

std::string on_row(const Panel& panel, std::size_t row) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& cell = panel.cells[m][row];
    std::string part = option_name(panel.methods[m]) + " " + percent(cell.found.value());
    if (cell.lead && beyond_chance(*cell.lead))
      part += cell.lead->difference > 0 ? " (more, beyond chance)" : " (fewer, beyond chance)";
    parts.push_back(std::move(part));
  }
  return fmt::format("<b>{}</b>: {}.", escape_html(panel.rows[row]), fmt::join(parts, ", "));
}

}  // namespace

std::string headline(const Experiment& experiment, const ExperimentResults& results) {
  std::vector<std::string> parts;
  for (const Panel& panel : results.panels) {
    const std::string prefix = panel_prefix(experiment, panel);
    switch (results.kind) {
      case ExperimentKind::bins:
        parts.push_back(prefix + on_bins(panel));
        break;
      case ExperimentKind::groups:
        for (std::size_t row = 0; row < panel.rows.size(); ++row)
          parts.push_back(on_row(panel, row));
        break;
      case ExperimentKind::steps:
        for (std::size_t m = 0; m < panel.methods.size(); ++m)
          parts.push_back(prefix + on_steps(panel, m));
        break;
      case ExperimentKind::parameter:
        for (std::size_t m = 0; m < panel.methods.size(); ++m)
          parts.push_back(prefix + on_parameter(panel, m));
        break;
      case ExperimentKind::conditions:
        parts.push_back(prefix + on_conditions(panel));
        break;
    }
  }
  return fmt::format("{}", fmt::join(parts, " "));
}

}  // namespace trivet::apps::study
