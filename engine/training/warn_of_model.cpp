#include "engine/training/warn_of_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "kernels/surfaces/visibility.hpp"
#include "storage/common/counted.hpp"

namespace trivet::engine {
namespace {

constexpr double kMostVisibleShare = 0.9;  // one view sees about half of a closed surface
constexpr double kMostHidden = 0.3;
constexpr double kMostTurned = 0.5;
constexpr double kMostOpen = 0.05;
constexpr std::size_t kFewestPoints = 500;
constexpr float kSmallest_m = 0.002F, kLargest_m = 10;  // range of diameters of objects in scans
constexpr std::array kOtherUnits{1000.0, 25.4, 10.0};   // ratios of commonly confused units
constexpr double kTypicalSpread = 30;  // ratio of diameters within one library, in either direction

double share(std::size_t part, std::size_t all) {
  return all == 0 ? 0 : static_cast<double>(part) / static_cast<double>(all);
}

/// The share of samples visible in the view that sees most.
double most_visible_share(std::span<const ViewMask> views) {
  std::array<std::size_t, kernels::kNumViews> visible{};
  for (const ViewMask& mask : views) {
    for (std::size_t d = 0; d < visible.size(); ++d)
      visible[d] += kernels::is_visible(mask, d) ? 1 : 0;
  }
  return share(*std::ranges::max_element(visible), views.size());
}

/// The area missing from a closed surface: 0 for a closed surface, up to 1 for a sheet. It is the
/// norm of the sum of area vectors, which equals that of the holes.
double open_share(const SurveyedModel& model) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t t = 0; t < model.triangles.size(); ++t) {
    const Eigen::Vector3d a = model.vertices[model.triangles.a[t]].cast<double>();
    const Eigen::Vector3d b = model.vertices[model.triangles.b[t]].cast<double>();
    const Eigen::Vector3d c = model.vertices[model.triangles.c[t]].cast<double>();
    sum += 0.5 * (b - a).cross(c - a);
  }
  return model.has_faces() ? sum.norm() / model.areas.back() : 0;
}

/// Length without an exponent; many millimeters are shown in meters.
std::string length_text(double length, LengthUnit unit) {
  constexpr double kMany = 1e4;
  if (unit == LengthUnit::millimeter && length >= kMany)
    return fmt::format("{:.4g} m", unit_scale(unit, LengthUnit::meter) * length);
  return fmt::format("{:.4g} {}", length, unit_name(unit));
}

}  // namespace

std::vector<std::string> warn_of_model(const SurveyedModel& model) {
  std::vector<std::string> warnings;
  if (model.num_unused > 0) {
    warnings.push_back(
        fmt::format("{} on no face left out", counted(model.num_unused, "vertex", "vertices")));
  }
  if (model.num_without_area > 0) {
    warnings.push_back(
        fmt::format("{} without area left out", counted(model.num_without_area, "triangle")));
  }
  if (const double visible = most_visible_share(model.sample_views); visible > kMostVisibleShare) {
    warnings.push_back(
        fmt::format("one view sees {:.0f} % of it, as of a scene or a scan from one "
                    "side; give the whole object",
                    100 * visible));
  }
  if (const double hidden = share(model.num_hidden(), model.all_views.size());
      hidden > kMostHidden) {
    warnings.push_back(
        fmt::format("{:.0f} % of its surface can be seen from nowhere; remove what "
                    "lies inside, if it is not meant",
                    100 * hidden));
  }
  if (const double turned = share(model.num_turned, model.all_views.size()); turned > kMostTurned) {
    warnings.push_back(
        fmt::format("{:.0f} % of its faces point inwards; they are used the other "
                    "way round",
                    100 * turned));
  }
  if (const double open = open_share(model); open > kMostOpen) {
    warnings.push_back(
        fmt::format("its surface is open, or its faces are wound unevenly: {:.0f} % "
                    "of its area has nothing across from it",
                    100 * open));
  }
  if (!model.has_faces() && model.vertices.size() < kFewestPoints) {
    warnings.push_back(fmt::format("only {} points; {} or more, all around, show its shape",
                                   model.vertices.size(), kFewestPoints));
  }
  return warnings;
}

std::vector<std::string> warn_of_sizes(std::span<const float> diameters, LengthUnit unit) {
  std::vector<std::string> warnings(diameters.size());
  std::vector<float> sorted(diameters.begin(), diameters.end());
  std::ranges::sort(sorted);
  const double median = sorted.empty() ? 0 : static_cast<double>(sorted[sorted.size() / 2]);
  const double in_meters = unit == LengthUnit::meter ? 1 : 1e-3;
  for (std::size_t m = 0; m < diameters.size(); ++m) {
    const auto diameter = static_cast<double>(diameters[m]);
    const double ratio = diameter / median;
    if (const double meters = diameter * in_meters;
        meters > static_cast<double>(kLargest_m) || meters < static_cast<double>(kSmallest_m)) {
      warnings[m] = fmt::format("{} across; is the unit right?", length_text(diameter, unit));
    } else if (sorted.size() > 2 && (ratio > kTypicalSpread || ratio < 1 / kTypicalSpread)) {
      const auto other = std::ranges::min_element(kOtherUnits, {}, [&](double factor) {
        return std::abs(std::abs(std::log(ratio)) - std::log(factor));
      });
      warnings[m] = fmt::format(
          "{} across, where half of the models are within {}; is the unit "
          "right? Its file's lengths may be {} times too {}",
          length_text(diameter, unit), length_text(median, unit), *other,
          ratio > 1 ? "large" : "small");
    }
  }
  return warnings;
}

}  // namespace trivet::engine
