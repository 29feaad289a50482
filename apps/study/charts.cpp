#include "apps/study/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <vector>

#include "apps/report/svg.hpp"

namespace trivet::apps::study {
namespace {

// In the units of the drawing.
constexpr double kWidth = 520;
constexpr double kLeft = 62, kRight = 14, kTop = 22, kPlotHeight = 250;              // of curves
constexpr double kNamesLeft = 190, kRowHeight = 13, kRowGap = 12, kLineHeight = 13;  // of rows
constexpr double kRowsTop = 26;
constexpr double kMarkStep = 8;  // between methods at one place of a curve

/// Maps values to 0..1, with the positions of ticks.
struct Scale {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  double operator()(double value) const {
    const double clamped = std::clamp(value, low, high);
    if (logarithmic) return std::log(clamped / low) / std::log(high / low);
    return (clamped - low) / (high - low);
  }
};

/// A scale for fractions: from 0, or from slightly below the lowest drawn value, in steps of a
/// fifth of the range.
Scale rate_scale(const Panel& panel) {
  double least = 1;
  for (const std::vector<PanelCell>& column : panel.cells) {
    for (const PanelCell& cell : column) {
      if (cell.found.all > 0) least = std::min(least, cell.found.interval().first);
    }
  }
  Scale scale;
  scale.low = least > 0.8 ? 0.75 : least > 0.55 ? 0.5 : 0;
  for (int i = 0; i <= 5; ++i) scale.ticks.push_back(scale.low + i * (1 - scale.low) / 5);
  return scale;
}

/// Round numbers from 0 on, or powers of ten if the largest is more than 12 times the least.
Scale time_scale(double least, double most) {
  Scale scale;
  scale.logarithmic = least > 0 && most > 12 * least;
  const auto nice = [](double value, bool up) {
    const double power = std::pow(10, std::floor(std::log10(value)));
    const double digits = value / power;
    for (const double step : {1.0, 2.0, 5.0, 10.0}) {
      if (up && step >= digits - 1e-9) return step * power;
    }
    return (digits >= 5 ? 5 : digits >= 2 ? 2 : 1) * power;
  };
  if (!scale.logarithmic) {
    const double step = nice(std::max(most, 1e-6) / 5, true);
    scale.low = 0;
    scale.high = step * std::ceil(most / step - 1e-9);
    for (int i = 0; i * step <= scale.high + 1e-9; ++i) scale.ticks.push_back(i * step);
    return scale;
  }
  scale.low = nice(least, false);
  scale.high = nice(most, true);
  for (double tick = scale.low; tick < 1.001 * scale.high; tick = nice(1.01 * tick, true))
    scale.ticks.push_back(tick);
  return scale;
}

/// A value to draw.
struct Mark {
  double value = 0, low = 0, high = 0;
  std::string title;
};

/// The drawn values of a panel: for each method, one mark per row, or none.
struct Drawing {
  Scale scale;
  std::string label, unit;  ///< label of the axis, and unit of its ticks
  std::vector<std::vector<std::optional<Mark>>> marks;

  std::string number(double value) const {
    return unit == "%" ? fmt::format("{:.0f}", 100 * value) : fmt::format("{:g}", value);
  }
  std::string axis() const {
    return fmt::format("{} [{}]{}", label, unit, scale.logarithmic ? ", logarithmic" : "");
  }
};

/// The label of the rows, with the unit of bins of truths, whose names contain theirs.
std::string rows_axis(const Panel& panel) {
  if (panel.axis.empty()) return "variant";
  return panel.has_total ? panel.axis + " [share of the area]" : panel.axis;
}

std::string dot(Method method, double x, double y, const std::string& title) {
  return svg_dot(choice_name(method), 3.6, x, y, title);
}

std::size_t num_drawn(const Panel& panel) { return panel.rows.size() - (panel.has_total ? 1 : 0); }

/// Rows from left to right, values upward, a line per method. The style depends on the method's
/// name.
std::string curve_chart(const Panel& panel, const Drawing& drawing) {
  const double plot = kWidth - kLeft - kRight, bottom = kTop + kPlotHeight;
  const auto n = static_cast<double>(num_drawn(panel));
  const auto across = [&](std::size_t row) {
    return kLeft + plot * (static_cast<double>(row) + 0.5) / n;
  };
  const auto down = [&](double value) { return bottom - kPlotHeight * drawing.scale(value); };
  std::string out = svg_start(kWidth, bottom + 46, drawing.axis() + " over " + rows_axis(panel));
  for (const double tick : drawing.scale.ticks) {
    out += fmt::format("<path class=\"grid\" d=\"M{} {:.1f}H{}\"/>", kLeft, down(tick),
                       kWidth - kRight) +
           svg_text("end", kLeft - 6, down(tick) + 4, drawing.number(tick));
  }
  for (std::size_t row = 0; row < num_drawn(panel); ++row) {
    out += svg_text("mid", across(row), bottom + 17, panel.rows[row]);
  }
  out += svg_text("mid name", kLeft + plot / 2, bottom + 38, rows_axis(panel));
  out += svg_upward_name(13, bottom - kPlotHeight / 2, drawing.axis());
  if (panel.reference == Reference::fixed) {
    const double x = across(panel.reference_row);
    out += fmt::format("<path class=\"ideal\" d=\"M{:.1f} {}V{}\"/>", x, kTop, bottom) +
           svg_text("mid", x, kTop - 6, "default");
  }
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    const double shift =
        kMarkStep * (static_cast<double>(m) - static_cast<double>(panel.methods.size() - 1) / 2);
    std::string path, marks;
    for (std::size_t row = 0; row < num_drawn(panel); ++row) {
      const std::optional<Mark>& mark = drawing.marks[m][row];
      if (!mark) continue;
      const double x = across(row) + shift;
      path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? 'M' : 'L', x, down(mark->value));
      if (mark->high > mark->low) {
        marks += fmt::format("<path class=\"whisker\" d=\"M{:.1f} {:.1f}V{:.1f}\"/>", x,
                             down(mark->low), down(mark->high));
      }
      marks += dot(panel.methods[m], x, down(mark->value), mark->title);
    }
    out += fmt::format("<g class=\"{0}\"><path class=\"line\" d=\"{1}\"/>{2}</g>",
                       choice_name(panel.methods[m]), path, marks);
  }
  return out + "</svg>\n";
}

/// Breaks a name at spaces into lines of about this many letters.
std::vector<std::string> lines_of(const std::string& name) {
  constexpr std::size_t kLetters = 25;
  std::vector<std::string> lines{""};
  std::istringstream words(name);
  for (std::string word; words >> word;) {
    if (!lines.back().empty() && lines.back().size() + 1 + word.size() > kLetters)
      lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

/// Rows from top to bottom, values to the right.
std::string row_chart(const Panel& panel, const Drawing& drawing) {
  const double plot = kWidth - kNamesLeft - kRight - 8;
  const auto num_methods = static_cast<double>(panel.methods.size());
  std::size_t num_lines = 1;  // number of lines of the longest name
  for (const std::string& name : panel.rows) num_lines = std::max(num_lines, lines_of(name).size());
  const double row_height =
      std::max(kRowHeight * num_methods, kLineHeight * static_cast<double>(num_lines)) + kRowGap;
  const double bottom = kRowsTop + row_height * static_cast<double>(panel.rows.size());
  const auto across = [&](double value) { return kNamesLeft + plot * drawing.scale(value); };
  std::string out = svg_start(kWidth, bottom + 44, drawing.axis() + " over " + rows_axis(panel)) +
                    svg_text("end name", kNamesLeft - 10, kRowsTop - 10, rows_axis(panel));
  for (const double tick : drawing.scale.ticks) {
    out += fmt::format("<path class=\"grid\" d=\"M{:.1f} {}V{:.1f}\"/>", across(tick), kRowsTop,
                       bottom) +
           svg_text("mid", across(tick), bottom + 17, drawing.number(tick));
  }
  out += svg_text("mid name", kNamesLeft + plot / 2, bottom + 37, drawing.axis());
  for (std::size_t row = 0; row < panel.rows.size(); ++row) {
    const double top = kRowsTop + row_height * static_cast<double>(row);
    const bool usual = panel.reference == Reference::fixed && row == panel.reference_row;
    const std::vector<std::string> lines = lines_of(panel.rows[row]);
    for (std::size_t k = 0; k < lines.size(); ++k) {
      const double middle = static_cast<double>(k) - static_cast<double>(lines.size() - 1) / 2;
      out += svg_text(usual ? "end name" : "end", kNamesLeft - 10,
                      top + row_height / 2 + 4 + kLineHeight * middle, lines[k]);
    }
    for (std::size_t m = 0; m < panel.methods.size(); ++m) {
      const std::optional<Mark>& mark = drawing.marks[m][row];
      if (!mark) continue;
      const double y =
          top + row_height / 2 + kRowHeight * (static_cast<double>(m) + 0.5 - num_methods / 2);
      out += fmt::format("<g class=\"{}\">", choice_name(panel.methods[m]));
      if (mark->high > mark->low) {
        out += fmt::format("<path class=\"whisker\" d=\"M{:.1f} {:.1f}H{:.1f}\"/>",
                           across(mark->low), y, across(mark->high));
      }
      out += dot(panel.methods[m], across(mark->value), y, mark->title) + "</g>";
    }
  }
  return out + "</svg>\n";
}

std::string draw(const Panel& panel, const Drawing& drawing) {
  return panel.is_curve ? curve_chart(panel, drawing) : row_chart(panel, drawing);
}

}  // namespace

std::string rate_chart(const Panel& panel) {
  Drawing drawing{rate_scale(panel), "share found", "%", {}};
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    std::vector<std::optional<Mark>> marks;
    for (std::size_t row = 0; row < panel.rows.size(); ++row) {
      const PanelCell& cell = panel.cells[m][row];
      const auto [low, high] = cell.found.interval();
      marks.push_back(
          cell.found.all == 0
              ? std::nullopt
              : std::optional(
                    Mark{cell.found.value(), low, high,
                         fmt::format("{}, {}: {} of {}, {:.1f} %", choice_name(panel.methods[m]),
                                     panel.rows[row], cell.found.right, cell.found.all,
                                     100 * cell.found.value())}));
    }
    drawing.marks.push_back(std::move(marks));
  }
  return draw(panel, drawing);
}

std::string time_chart(const Panel& panel) {
  if (panel.has_total) return "";  // times belong to scenes, not to bins of truths
  Drawing drawing{{}, "time of a scene on one core", "s", {}};
  double least = 0, most = 0;
  for (std::size_t m = 0; m < panel.methods.size(); ++m) {
    std::vector<std::optional<Mark>> marks;
    for (std::size_t row = 0; row < panel.rows.size(); ++row) {
      const std::optional<double>& seconds = panel.cells[m][row].seconds;
      marks.emplace_back();
      if (!seconds) continue;
      least = most == 0 ? *seconds : std::min(least, *seconds);
      most = std::max(most, *seconds);
      marks.back() = Mark{*seconds, *seconds, *seconds,
                          fmt::format("{}, {}: {:.2f} s", choice_name(panel.methods[m]),
                                      panel.rows[row], *seconds)};
    }
    drawing.marks.push_back(std::move(marks));
  }
  if (most == 0) return "";
  drawing.scale = time_scale(least, most);
  return draw(panel, drawing);
}

std::string chart_key(const Panel& panel) {
  std::string out = "<p class=\"key\">";
  for (const Method method : panel.methods) {
    out += fmt::format("<span><i class=\"dot {}\"></i>{}</span>", choice_name(method),
                       choice_name(method));
  }
  return out + "</p>\n";
}

}  // namespace trivet::apps::study
