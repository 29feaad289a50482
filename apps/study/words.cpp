#include "apps/study/words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/option_names.hpp"
#include "apps/report_html.hpp"

namespace trivet::apps {
namespace {

constexpr double kMaxP = 0.05;
constexpr double kHeld = 0.9;  // of what is found undisturbed
constexpr std::size_t kMostNamed = 6;

std::string alarms(const PanelCell& cell) {
  const std::size_t n = cell.false_positives.value_or(0);
  return n == 0 ? "no false alarm" : counted(n, "false alarm", "false alarms");
}

/// "0.02", or "0.02 to 0.05" for neighbours, commas between.
std::string name_rows(const Panel& panel, const std::vector<std::size_t>& rows) {
  std::vector<std::string> parts;
  for (std::size_t i = 0; i < rows.size();) {
    std::size_t last = i;
    while (last + 1 < rows.size() && rows[last + 1] == rows[last] + 1 && panel.is_curve) ++last;
    const std::string first = escape_html(panel.rows[rows[i]]);
    parts.push_back(last > i + 1 ? first + " to " + escape_html(panel.rows[rows[last]]) : first);
    i = last > i + 1 ? last + 1 : i + 1;
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The prefix of sentences about one panel.
std::string about(const Experiment& experiment, const Panel& panel) {
  return experiment.scenes.size() > 1 && !panel.title.empty()
             ? "<b>" + escape_html(panel.title) + "</b>: "
             : "";
}

/// The row with the best F1; the default unless another is better.
std::size_t best_row(const Panel& panel, std::size_t m) {
  std::size_t best = panel.reference_row;
  for (std::size_t row = 0; row < panel.rows.size(); ++row) {
    if (panel.cells[m][row].f1 > panel.cells[m][best].f1) best = row;
  }
  return best;
}

std::string seconds_text(const PanelCell& cell) {
  return cell.seconds ? fmt::format("{:.2f} s", *cell.seconds) : std::string("-");
}

// A parameter: where the default lies.

std::string on_parameter(const Experiment& experiment, const Panel& panel, std::size_t m) {
  const std::vector<PanelCell>& cells = panel.cells[m];
  const std::size_t usual = panel.reference_row, best = best_row(panel, m);
  std::string out = about(experiment, panel) + option_name(panel.methods[m]) + " finds " +
                    rate_text(cells[usual].found) + " at the default, " +
                    escape_html(panel.rows[usual]) + ", with " + alarms(cells[usual]) + ", in " +
                    seconds_text(cells[usual]) + ". ";
  if (best == usual) {
    out += "No other value has a better F1.";
  } else {
    const std::optional<PairedComparison>& change = cells[best].change;
    out += fmt::format("The best F1 is at {} ({}, {}, {})", escape_html(panel.rows[best]),
                       percent(cells[best].found.value()), alarms(cells[best]),
                       seconds_text(cells[best]));
    if (change) {
      out += fmt::format(
          ": {}, {}", difference_text(*change),
          beyond_chance(*change) ? "more than chance explains" : "which chance explains");
    }
    out += ".";
  }
  std::vector<std::size_t> worse, better;
  for (std::size_t row = 0; row < cells.size(); ++row) {
    if (!cells[row].change || !beyond_chance(*cells[row].change)) continue;
    (cells[row].change->difference < 0 ? worse : better).push_back(row);
  }
  if (!worse.empty()) out += " Beyond chance fewer are found at " + name_rows(panel, worse) + ".";
  if (!better.empty()) out += " Beyond chance more are found at " + name_rows(panel, better) + ".";
  if (worse.empty() && better.empty()) out += " No value differs from the default beyond chance.";
  return out;
}

// Conditions: which method bears them.

std::string on_methods(const Panel& panel) {
  std::vector<std::string> rates, leads;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    Rate all;
    std::size_t alarms_of_all = 0;
    for (const PanelCell& cell : panel.cells[m]) {
      all.right += cell.found.right;
      all.all += cell.found.all;
      alarms_of_all += cell.false_positives.value_or(0);
    }
    rates.push_back(
        fmt::format("{} {} with {}", option_name(panel.methods[m]), percent(all.value()),
                    alarms_of_all == 0 ? "no false alarm"
                                       : counted(alarms_of_all, "false alarm", "false alarms")));
    if (panel.leads[m]) {
      leads.push_back(fmt::format("{} less {}: {}", option_name(panel.methods[m]),
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
    std::vector<std::size_t> ahead, behind;
    for (std::size_t row = 0; row < panel.rows.size(); ++row) {
      const std::optional<PairedComparison>& lead = panel.cells[m][row].lead;
      if (!lead || !beyond_chance(*lead)) continue;
      (lead->difference > 0 ? ahead : behind).push_back(row);
    }
    for (const auto& [rows, word] : {std::pair{&ahead, "more"}, {&behind, "fewer"}}) {
      if (rows->empty()) continue;
      out += fmt::format(" Beyond chance {} finds {} than {} at {}.", option_name(panel.methods[m]),
                         word, option_name(panel.methods[0]), name_rows(panel, *rows));
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
  std::string out = about(experiment, panel) + on_methods(panel);
  if (panel.is_curve) out += " " + on_bearing(panel);
  out += on_leads(panel);
  return panel.is_curve ? out + on_times(panel) : out;
}

// Steps: what each adds.

std::string on_steps(const Experiment& experiment, const Panel& panel, std::size_t m) {
  const std::vector<PanelCell>& cells = panel.cells[m];
  const PanelCell &first = cells.front(), &last = cells.back();
  std::string out =
      about(experiment, panel) +
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

constexpr std::string_view kStronglyOccluded = ">84%";

std::string on_bins(const Experiment& experiment, const Panel& panel) {
  std::string out = about(experiment, panel);
  const auto strong = std::ranges::find(panel.rows, kStronglyOccluded);
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& all = panel.cells[m].back();
    const std::size_t reported = all.found.right + all.false_positives.value_or(0);
    std::string part = option_name(panel.methods[m]) + " finds ";
    if (strong != panel.rows.end()) {
      Rate below;
      for (std::size_t row = 0; row < static_cast<std::size_t>(strong - panel.rows.begin());
           ++row) {
        below.right += panel.cells[m][row].found.right;
        below.all += panel.cells[m][row].found.all;
      }
      part += fmt::format("{} of the {} instances less than 84 % occluded, ", rate_text(below),
                          below.all);
    }
    part +=
        fmt::format("{} of all {}, with {} ({} of what it reports)", rate_text(all.found),
                    all.found.all, alarms(all),
                    percent(reported > 0 ? static_cast<double>(all.false_positives.value_or(0)) /
                                               static_cast<double>(reported)
                                         : 0));
    if (all.lead)
      part +=
          fmt::format("; less {}: {}", option_name(panel.methods[0]), difference_text(*all.lead));
    parts.push_back(std::move(part));
  }
  return out + fmt::format("In {}, {}.",
                           counted(panel.cells[0].back().num_scenes, "scene", "scenes"),
                           fmt::join(parts, ". "));
}

// Kinds of scenes.

std::string on_row(const Panel& panel, std::size_t row) {
  std::vector<std::string> parts;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const PanelCell& cell = panel.cells[m][row];
    std::string part = fmt::format("{} {}, {}, {}", option_name(panel.methods[m]),
                                   rate_text(cell.found), alarms(cell), seconds_text(cell));
    if (cell.lead) {
      part +=
          fmt::format(" (less {}: {})", option_name(panel.methods[0]), difference_text(*cell.lead));
    }
    parts.push_back(std::move(part));
  }
  return fmt::format("<b>{}</b>: {}.", escape_html(panel.rows[row]), fmt::join(parts, "; "));
}

}  // namespace

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string rate_text(const Rate& rate) {
  const auto [low, high] = rate.interval();
  return fmt::format("{} ({:.1f} to {:.1f})", percent(rate.value()), 100 * low, 100 * high);
}

std::string difference_text(const PairedComparison& comparison) {
  const std::string p =
      comparison.p < 0.001 ? "p &lt; 0.001" : fmt::format("p {:.2g}", comparison.p);
  return fmt::format("{:+.1f} points ({:+.1f} to {:+.1f}, {})", 100 * comparison.difference,
                     100 * comparison.low, 100 * comparison.high, p);
}

bool beyond_chance(const PairedComparison& comparison) {
  return comparison.p < kMaxP && (comparison.low > 0 || comparison.high < 0);
}

std::vector<std::string> findings(const Experiment& experiment, const ExperimentResults& results) {
  std::vector<std::string> out;
  for (const Panel& panel : results.panels) {
    if (experiment.curve != Curve::variants) {
      out.push_back(on_bins(experiment, panel));
    } else if (experiment.variants.size() == 1) {
      for (std::size_t row = 0; row < panel.rows.size(); ++row) out.push_back(on_row(panel, row));
    } else if (panel.reference == Reference::previous) {
      for (std::size_t m = 0; m < panel.methods.size(); ++m)
        out.push_back(on_steps(experiment, panel, m));
    } else if (results.tunes && panel.reference == Reference::fixed) {
      for (std::size_t m = 0; m < panel.methods.size(); ++m)
        out.push_back(on_parameter(experiment, panel, m));
    } else {
      out.push_back(on_conditions(experiment, panel));
    }
  }
  return out;
}

}  // namespace trivet::apps
