#include "apps/study/charts.hpp"

#include <gtest/gtest.h>

namespace trivet::apps::study {
namespace {

/// One method under two conditions, with these run times in seconds.
Panel panel_of(const std::string& axis, bool is_curve, double first_seconds = 1) {
  Panel panel;
  panel.axis = axis;
  panel.is_curve = is_curve;
  panel.rows = {"0.1", "0.2"};
  panel.methods = {Method::ppf};
  panel.cells.resize(1);
  for (const double seconds : {first_seconds, 2.0}) {
    PanelCell cell;
    cell.found = {7, 10};
    cell.seconds = seconds;
    panel.cells[0].push_back(cell);
  }
  return panel;
}

bool holds(const std::string& chart, const std::string& text) {
  return chart.find(">" + text + "<") != std::string::npos;
}

TEST(StudyCharts, NameBothAxesWithTheirUnits) {
  for (const bool is_curve : {true, false}) {
    const Panel panel = panel_of("noise [diameters]", is_curve);
    const std::string rates = rate_chart(panel), times = time_chart(panel);
    for (const std::string& chart : {rates, times})
      EXPECT_TRUE(holds(chart, "noise [diameters]")) << chart;
    EXPECT_TRUE(holds(rates, "share found [%]")) << rates;
    EXPECT_TRUE(holds(rates, "100")) << "numbers leave the unit to the axis";
    EXPECT_TRUE(holds(times, "time of a scene on one core [s]")) << times;
  }
  EXPECT_TRUE(holds(rate_chart(panel_of("", false)), "variant"));
}

TEST(StudyCharts, SayWhereAnAxisIsLogarithmic) {
  EXPECT_TRUE(holds(time_chart(panel_of("models", true, 0.05)),
                    "time of a scene on one core [s], logarithmic"));
}

TEST(StudyCharts, NameTheUnitOfBinsOfTruths) {
  Panel panel = panel_of("occlusion", true);
  panel.has_total = true;
  EXPECT_TRUE(holds(rate_chart(panel), "occlusion [share of the area]"));
  EXPECT_EQ(time_chart(panel), "") << "times are of scenes";
}

}  // namespace
}  // namespace trivet::apps::study
