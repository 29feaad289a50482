#include "apps/study/phrases.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/report/html.hpp"

namespace trivet::apps::study {
namespace {

constexpr double kMaxP = 0.05;
constexpr std::string_view kStronglyOccluded = ">84%";

}  // namespace

std::string rate_text(const Rate& rate) {
  const auto [low, high] = rate.interval();
  return fmt::format("{} ({:.1f} to {:.1f})", percent(rate.value()), 100 * low, 100 * high);
}

std::string points_text(double difference) {
  const std::string digits = fmt::format("{:.1f}", std::abs(100 * difference));
  if (digits == "0.0") return digits;
  return (difference < 0 ? "\u2212" : "+") + digits;
}

std::string difference_text(const PairedComparison& comparison) {
  const std::string p =
      comparison.p < 0.001 ? "p &lt; 0.001" : fmt::format("p {:.2g}", comparison.p);
  return fmt::format("{} points ({} to {}, {})", points_text(comparison.difference),
                     points_text(comparison.low), points_text(comparison.high), p);
}

bool beyond_chance(const PairedComparison& comparison) {
  return comparison.p < kMaxP && (comparison.low > 0 || comparison.high < 0);
}

std::string seconds_text(const PanelCell& cell) {
  return cell.seconds ? fmt::format("{:.2f} s", *cell.seconds) : std::string("-");
}

std::string alarms_text(std::size_t num_false) {
  return num_false == 0 ? "no false alarm" : counted(num_false, "false alarm", "false alarms");
}

std::string rows_text(const Panel& panel, const std::vector<std::size_t>& rows) {
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

std::string panel_prefix(const Experiment& experiment, const Panel& panel) {
  return experiment.scenes.size() > 1 && !panel.title.empty()
             ? "<b>" + escape_html(panel.title) + "</b>: "
             : "";
}

DifferingRows differing_rows(const std::vector<PanelCell>& cells,
                             std::optional<PairedComparison> PanelCell::*comparison) {
  DifferingRows out;
  for (std::size_t row = 0; row < cells.size(); ++row) {
    const std::optional<PairedComparison>& difference = cells[row].*comparison;
    if (difference && beyond_chance(*difference))
      (difference->difference > 0 ? out.better : out.worse).push_back(row);
  }
  return out;
}

Rate sum_found(const std::vector<PanelCell>& cells) {
  Rate sum;
  for (const PanelCell& cell : cells) {
    sum.right += cell.found.right;
    sum.all += cell.found.all;
  }
  return sum;
}

std::size_t sum_false(const std::vector<PanelCell>& cells) {
  std::size_t sum = 0;
  for (const PanelCell& cell : cells) sum += cell.false_positives.value_or(0);
  return sum;
}

std::optional<Rate> found_below_84(const Panel& panel, std::size_t method) {
  const auto strong = std::ranges::find(panel.rows, kStronglyOccluded);
  if (strong == panel.rows.end()) return std::nullopt;
  const auto& cells = panel.cells[method];
  return sum_found({cells.begin(), cells.begin() + (strong - panel.rows.begin())});
}

}  // namespace trivet::apps::study
