#include "apps/words/recognition_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/inputs/inputs.hpp"
#include "apps/words/camera_words.hpp"
#include "apps/words/candidate_words.hpp"
#include "apps/words/place_text.hpp"
#include "apps/words/score_words.hpp"
#include "apps/words/view_words.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/common/counted.hpp"

namespace trivet::apps {

namespace {

/// A length in the form "220 mm" or "1.2 m".
std::string length_words(double length, LengthUnit unit) {
  const double meters = length * unit_scale(unit, LengthUnit::meter);
  return meters < 1 ? fmt::format("{:.3g} mm", 1000 * meters) : fmt::format("{:.3g} m", meters);
}

Advice rejected_advice(const RejectedPose& best, float min_score) {
  return {"rejected",
          fmt::format("The best rejected pose is {} with score {}, and the lowest score is {}.",
                      best.model, score_text(best.score), min_score)};
}

Advice sizes_advice(const Eigen::Vector3f& size, LengthUnit unit, const Library& library) {
  const auto [smallest, largest] =
      std::ranges::minmax_element(library.models, {}, &Model::diameter);
  const auto words = [&](float length) { return length_words(length, unit); };
  return {"sizes",
          fmt::format("In {}, the scan is {} × {} × {}, and the models are {} to {} across. Does "
                      "that fit?",
                      unit_name(unit), words(size.x()), words(size.y()), words(size.z()),
                      length_words(smallest->diameter, library.header.unit),
                      length_words(largest->diameter, library.header.unit))};
}

Advice view_advice(const SceneInput& scene) {
  if (scene.camera) {
    return {"camera",
            "Is the camera right? With a wrong focal length every shape is distorted, with a wrong "
            "depth scale every size is wrong."};
  }
  return {"viewpoint",
          "Is the viewpoint right? What the sensor saw through speaks against a model."};
}

/// A line, and one for each further candidate.
std::string detection_text(const Detection& detection, const Eigen::Vector3d& offset,
                           const char* unit) {
  std::string text =
      fmt::format("  {:<24} score {:.3f}  visible {:.2f}  rmse {:.3g} {}  at ({}) {}\n",
                  detection.model, detection.score, detection.visible_fraction, detection.rmse,
                  unit, place_text(detection, offset), unit);
  if (detection.candidates.size() < 2) return text;
  text += fmt::format("    one of {}: {}\n", detection.candidates.size(),
                      candidate_words(detection.candidates.front(), offset, unit));
  for (std::size_t k = 1; k < detection.candidates.size(); ++k)
    text += fmt::format("    or {}\n", candidate_words(detection.candidates[k], offset, unit));
  return text;
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
    for (const Advice& check : advice_on_nothing(scene, result, library, min_score)) {
      text += fmt::format("  check: {}{}\n", check.words,
                          check.about == "rejected" ? " --report FOLDER shows it." : "");
    }
  }
  if (!stats.camera_check) return text;
  if (const std::optional<std::string> finding = camera_finding(*stats.camera_check))
    text += fmt::format("  {}\n", *finding);
  return text;
}

std::vector<Advice> advice_on_nothing(const SceneInput& scene, const SceneResult& result,
                                      const Library& library, float min_score) {
  std::vector<Advice> checks;
  if (!result.stats.view) {
    checks.push_back(
        {"measurements", fmt::format("Is anything measured? A scan needs {} points or more.",
                                     engine::kFewestPoints)});
    return checks;
  }
  if (!result.rejected.empty() && result.rejected.front().score < min_score)
    checks.push_back(rejected_advice(result.rejected.front(), min_score));
  if (result.stats.num_points > 0 && !library.models.empty()) {
    checks.push_back(
        sizes_advice(result.stats.size, scene_unit(scene, library.header.unit), library));
  }
  checks.push_back(view_advice(scene));
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
