#include "apps/bop_csv.hpp"

#include <fmt/format.h>

#include <set>
#include <utility>

namespace trivet::apps {
namespace {

Error refuse(std::string_view what, std::string_view found) {
  return {ErrorCode::usage, fmt::format("--bop-csv: expected {}, found {}", what, found)};
}

}  // namespace

Result<void> check_bop_ids(const SceneInputs& scenes, const Library& library,
                           std::span<const std::string> models) {
  std::set<std::pair<int, int>> seen;
  for (std::size_t i = 0; i < scenes.sources.size(); ++i) {
    const std::string file = scenes.sources[i].file.string();
    const auto [scene, image] = scenes.ids[i];
    if (scene < 0 || image < 0)
      return refuse("scenes of a BOP data set, given as its folder", file);
    if (!seen.emplace(scene, image).second)
      return refuse(fmt::format("image {} of scene {} once", image, scene), file + " too");
  }
  std::vector<std::string> names(models.begin(), models.end());
  if (names.empty())
    for (const Model& model : library.models) names.push_back(model.name);
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
    result.t_mm = detection.T_scene_model.translation().cast<double>();
    result.seconds = found.stats.total_seconds;
    results.push_back(result);
  }
}

}  // namespace trivet::apps
