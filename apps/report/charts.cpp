#include "apps/report/charts.hpp"

#include <fmt/format.h>

#include "apps/report/svg.hpp"

namespace trivet::apps {
namespace {

// A square from 0 to 1 in both directions, in the units of the drawing.
constexpr double kLeft = 66, kTop = 14, kSide = 300;
constexpr double kWidth = kLeft + kSide + 26;

double across(double value) { return kLeft + kSide * value; }
double down(double value) { return kTop + kSide * (1 - value); }

/// Grid and axes, with the numbers 0 to 100 % beside the vertical one.
std::string axes(double height, std::string_view label, std::string_view horizontal,
                 std::string_view vertical, bool in_percent) {
  std::string out = svg_start(kWidth, height, label);
  for (int i = 0; i <= 5; ++i) {
    const double value = i / 5.0;
    out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {:.1f}H{:.1f}M{:.1f} {:.1f}V{:.1f}\"/>",
                       kLeft, down(value), across(1), across(value), down(0), down(1));
    const std::string share = fmt::format("{} %", 20 * i);
    out += svg_text("end", kLeft - 7, down(value) + 4, share);
    out += svg_text("mid", across(value), down(0) + 18,
                    in_percent ? share : fmt::format("{:.1f}", value));
  }
  return out + svg_text("mid name", across(0.5), down(0) + 37, horizontal) +
         svg_upward_name(13, down(0.5), vertical);
}

std::string mark(std::string_view style, double radius, double x, double y,
                 const std::string& title) {
  return svg_dot(style, radius, across(x), down(y), title);
}

}  // namespace

std::string precision_recall_chart(const Evaluation& evaluation) {
  std::string out = axes(kTop + kSide + 46, "precision over recall", "recall", "precision", true);
  std::string path;
  for (const OperatingPoint& point : evaluation.curve.points) {
    // A threshold between two scores gives no point between theirs: the curve has steps.
    if (path.empty()) {
      path = fmt::format("M{:.1f} {:.1f}H{:.1f}", across(0), down(point.precision),
                         across(point.recall));
    } else {
      path += fmt::format("V{:.1f}H{:.1f}", down(point.precision), across(point.recall));
    }
  }
  if (!path.empty()) out += fmt::format("<path class=\"curve\" d=\"{}\"/>", path);
  if (const auto& best = evaluation.curve.best_f1) {
    out += mark("best", 8, best->recall, best->precision,
                fmt::format("best F1 {:.3f} at score {:.3f}", best->f1(), best->score));
  }
  const Tally& total = evaluation.total;
  if (total.right + total.false_positives > 0)
    out += mark("reported", 4.5, total.recall(), total.precision(), "reported");
  return out + "</svg>\n";
}

std::string calibration_chart(const Calibration& calibration) {
  std::string out = axes(kTop + kSide + 66, "share of right detections over their score", "score",
                         "right", false);
  out += fmt::format("<path class=\"ideal\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>", across(0),
                     down(0), across(1), down(1));
  std::string path, marks;
  for (const CalibrationBin& bin : calibration.bins) {
    if (bin.all == 0) continue;
    const double share = static_cast<double>(bin.right) / static_cast<double>(bin.all);
    const auto [low, high] = wilson_interval(bin.right, bin.all);
    const double x = across(bin.mean_score);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x, down(share));
    marks += fmt::format("<path class=\"range\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x, down(low),
                         down(high));
    marks += mark("share", 5, bin.mean_score, share,
                  fmt::format("{} of {} right at scores {:.1f} to {:.1f}", bin.right, bin.all,
                              bin.low, bin.high));
    marks += svg_text("mid number", across((bin.low + bin.high) / 2), down(0) + 58,
                      fmt::format("{}", bin.all));
  }
  out += svg_text("end number", kLeft - 4, down(0) + 58, "detections");
  return out + fmt::format("<path class=\"curve\" d=\"{}\"/>", path) + marks + "</svg>\n";
}

}  // namespace trivet::apps
