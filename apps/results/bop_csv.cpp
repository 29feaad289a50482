#include "apps/results/bop_csv.hpp"

#include <fmt/format.h>

#include <limits>
#include <map>
#include <set>
#include <utility>

namespace trivet::apps {
namespace {

Error refuse(std::string_view what, std::string_view found) {
  return {ErrorCode::usage, fmt::format("--bop-csv, --coco: expected {}, found {}", what, found)};
}

}  // namespace

std::optional<std::string> bop_name_warning(const std::filesystem::path& file) {
  if (is_bop_result_name(file)) return std::nullopt;
  return fmt::format(
      "{}: BOP's tools learn the data set from the name of a file, and expect one such as "
      "trivet_lmo-test{}: METHOD_DATASET-SPLIT",
      file.string(), file.extension().string());
}

Result<void> check_bop_ids(const SceneInputs& scenes, const Library& library,
                           std::span<const std::string> models) {
  std::set<std::pair<int, int>> visited;
  for (std::size_t i = 0; i < scenes.sources.size(); ++i) {
    const std::string file = scenes.sources[i].file.string();
    const auto [scene, image] = scenes.ids[i];
    if (scene < 0 || image < 0)
      return refuse("scenes of a BOP data set, given as its folder", file);
    if (!visited.emplace(scene, image).second)
      return refuse(fmt::format("image {} of scene {} once", image, scene), file + " too");
  }
  std::vector<std::string> names(models.begin(), models.end());
  if (names.empty())
    for (const ModelInfo& model : library.models) names.push_back(model.name);
  for (const std::string& name : names) {
    if (!scenes.object_ids.contains(name)) {
      return refuse("models named as in the BOP data set (obj_000001)",
                    fmt::format("'{}'; train the data set, or choose models with --models", name));
    }
  }
  return {};
}

void add_bop_results(const SceneInputs& scenes, std::size_t index, const SceneResult& found,
                     std::vector<BopResult>& results) {
  for (const Detection& detection : found.detections) {
    BopResult result;
    result.scene_id = scenes.ids[index].scene;
    result.image_id = scenes.ids[index].image;
    result.object_id = scenes.object_ids.at(detection.model);
    result.score = detection.score;
    result.R = detection.T_scene_model.linear().cast<double>();
    result.t_mm = in_file_frame(detection.T_scene_model, found.offset).translation();
    result.seconds = found.stats.total_seconds;
    results.push_back(result);
  }
}

Result<std::vector<std::optional<SceneResult>>> read_bop_detections(
    const std::filesystem::path& file, const Manifest& manifest) {
  const Result<std::vector<BopResult>> stored = read_bop_results(file);
  if (!stored) return stored.error();
  std::map<std::pair<int, int>, std::size_t> scenes;
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    const ManifestScene& scene = manifest.scenes[s];
    if (scene.scene_id < 0 || scene.image_id < 0) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected BOP results together with the folder of their data "
                               "set, found a manifest",
                               file.string())};
    }
    scenes.emplace(std::pair(scene.scene_id, scene.image_id), s);
  }
  std::map<int, std::string> names;
  for (const ManifestModel& model : manifest.models) names.emplace(model.object_id, model.name);

  std::vector<std::optional<SceneResult>> results(manifest.scenes.size());
  for (const BopResult& result : *stored) {
    const auto scene = scenes.find({result.scene_id, result.image_id});
    if (scene == scenes.end()) continue;  // an image that is not a target
    const auto name = names.find(result.object_id);
    if (name == names.end()) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}: expected objects of the data set, found object {}",
                               file.string(), result.object_id)};
    }
    Detection detection;
    detection.model = name->second;
    detection.score = static_cast<float>(result.score);
    detection.T_scene_model.linear() = result.R.cast<float>();
    detection.T_scene_model.translation() = result.t_mm.cast<float>();
    detection.visible_fraction = detection.violation = detection.contour = detection.rmse =
        std::numeric_limits<float>::quiet_NaN();
    std::optional<SceneResult>& found = results[scene->second];
    if (!found) found.emplace();
    found->detections.push_back(std::move(detection));
    if (result.seconds > 0) found->stats.total_seconds = result.seconds;
  }
  return results;
}

}  // namespace trivet::apps
