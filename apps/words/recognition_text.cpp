#include "apps/words/recognition_text.hpp"

#include <fmt/args.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <utility>

#include "apps/inputs/inputs.hpp"
#include "apps/words/camera_words.hpp"
#include "apps/words/place_text.hpp"
#include "apps/words/view_words.hpp"
#include "storage/common/counted.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps {

std::span<const std::pair<std::string_view, std::string_view>> embedded_advice();

namespace {

/// A sentence of web/src/advice.json, where values replace {names}.
template <class... Values>
std::string advice(const char* name, const Values&... values) {
  static const nlohmann::json words = parse_json(embedded_advice()[0].second);
  return fmt::format(fmt::runtime(words.at(name).get<std::string>()), values...);
}

/// A length in the form "220 mm" or "1.2 m".
std::string length_words(double length, LengthUnit unit) {
  const double meters = length * unit_scale(unit, LengthUnit::meter);
  return meters < 1 ? fmt::format("{:.3g} mm", 1000 * meters) : fmt::format("{:.3g} m", meters);
}

std::string sizes_advice(const Eigen::Vector3f& size, LengthUnit unit, const Library& library) {
  const auto [smallest, largest] =
      std::ranges::minmax_element(library.models, {}, &Model::diameter);
  const auto words = [&](float length) { return length_words(length, unit); };
  return advice(
      "sizes", fmt::arg("unit", unit_name(unit)),
      fmt::arg("scan", words(size.x()) + " × " + words(size.y()) + " × " + words(size.z())),
      fmt::arg("smallest", length_words(smallest->diameter, library.header.unit)),
      fmt::arg("largest", length_words(largest->diameter, library.header.unit)));
}

std::string detection_text(const Detection& detection, const Eigen::Vector3d& offset,
                           const char* unit) {
  return fmt::format("  {:<24} score {:.3f}  visible {:.2f}  rmse {:.3g} {}  at ({}) {}\n",
                     detection.model, detection.score, detection.visible_fraction, detection.rmse,
                     unit, place_text(detection, offset), unit);
}

}  // namespace

std::string scene_text(const SceneInput& scene, const SceneResult& result, const Library& library,
                       float min_score) {
  const LengthUnit unit = scene_unit(scene, library.header.unit);
  const SceneStats& stats = result.stats;
  std::string text = fmt::format("{}: {}, {:.3f} s, {} found\n", scene.file.string(),
                                 counted(stats.num_points, "point"), stats.total_seconds,
                                 result.detections.size());
  const std::optional<std::string> view = stats.view ? view_words(*stats.view) : std::nullopt;
  if (view) text += fmt::format("  {}\n", *view);
  if (stats.num_stray > 0) {
    text += fmt::format(
        "  left out: {}, which the sensor can hardly have measured: far beyond all "
        "others\n",
        counted(stats.num_stray, "stray point"));
  }
  for (const Detection& detection : result.detections)
    text += detection_text(detection, result.offset, unit_name(unit));
  if (result.detections.empty()) {
    for (const std::string& check : advice_on_nothing(scene, result, library, min_score))
      text += "  check: " + check + '\n';
  }
  if (!stats.camera_check) return text;
  if (const std::optional<std::string> finding = camera_finding(*stats.camera_check))
    text += fmt::format("  {}\n", *finding);
  return text;
}

std::vector<std::string> advice_on_nothing(const SceneInput& scene, const SceneResult& result,
                                           const Library& library, float min_score) {
  std::vector<std::string> checks;
  if (!result.rejected.empty()) {
    const RejectedPose& best = result.rejected.front();
    checks.push_back(advice("rejected", fmt::arg("model", best.model),
                            fmt::arg("score", fmt::format("{:.3f}", best.score)),
                            fmt::arg("limit", min_score)) +
                     " --report FOLDER shows it.");
  }
  if (result.stats.num_points > 0 && !library.models.empty())
    checks.push_back(
        sizes_advice(result.stats.size, scene_unit(scene, library.header.unit), library));
  checks.push_back(advice(scene.camera ? "camera" : "viewpoint"));
  return checks;
}

std::string camera_text(const CameraCheck& check) {
  const Camera& c = check.camera;
  const std::optional<std::string> finding = camera_finding(check);
  if (!finding) return {};
  return fmt::format("camera {:.6g},{:.6g},{:.6g},{:.6g},{:.6g}, by {}: {}\n", c.fx, c.fy, c.cx,
                     c.cy, c.depth_scale, counted(check.objects.size(), "object"), *finding);
}

}  // namespace trivet::apps
