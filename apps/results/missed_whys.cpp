#include "apps/results/missed_whys.hpp"

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "apps/words/explanation_words.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/libraries/edit_library.hpp"

namespace trivet::apps {
namespace {

/// The point of the truth's surface that is nearest to the sensor, in the frame of the scene's
/// file; none: the model has no mesh.
std::optional<Eigen::Vector3d> place_of(const ManifestScene& scene, const TruthInstance& truth,
                                        std::span<const EvaluationMesh> meshes) {
  const EvaluationMesh* const mesh = find_mesh(meshes, truth.model);
  if (!mesh) return std::nullopt;
  const Eigen::Vector3d sensor = scene.viewpoint.value_or(Eigen::Vector3d::Zero());
  const FilePose pose = truth.file_pose();
  Eigen::Vector3d nearest = Eigen::Vector3d::Zero();
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh->vertices.size(); ++i) {
    const Eigen::Vector3f vertex = mesh->vertices[i];
    const Eigen::Vector3d place = pose * vertex.cast<double>();
    const double distance = (place - sensor).squaredNorm();
    if (distance < least) {
      least = distance;
      nearest = place;
    }
  }
  return nearest;
}

}  // namespace

Result<MissedWhys> explain_missed(const Recognizer& recognizer, const Manifest& manifest,
                                  std::span<const EvaluationMesh> meshes,
                                  const Evaluation& evaluation, const RecognizeOptions& options,
                                  const Progress& progress) {
  const std::vector<SceneInput> scenes = scenes_of(manifest, recognizer.library().header.unit);
  std::size_t num_missed = 0, num_asked = 0;
  for (const SceneEvaluation& scene : evaluation.scenes)
    num_missed += scene.missing ? 0 : scene.missed.size();
  MissedWhys whys;
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    if (evaluation.scenes[s].missed.empty() || evaluation.scenes[s].missing) continue;
    const Result<Cloud> cloud = read_scene(scenes[s]);
    if (!cloud) return cloud.error();
    for (const std::size_t t : evaluation.scenes[s].missed) {
      progress(++num_asked, num_missed, manifest.scenes[s].name);
      const TruthInstance& truth = manifest.scenes[s].truth[t];
      const auto place = place_of(manifest.scenes[s], truth, meshes);
      if (!place || !find_model(recognizer.library(), truth.model)) continue;
      RecognizeOptions asking = options;
      asking.doubtful_score.reset();  // poses below the threshold stay rejected
      asking.explain.point = *place;
      asking.explain.models = {truth.model};
      const Result<SceneResult> result =
          recognize(recognizer, *cloud, scenes[s], asking, progress.stop);
      if (!result) return result.error();
      whys[{s, t}] = explanation_words(*result, result->explanation->models.front(),
                                       recognizer.score(), asking);
    }
  }
  return whys;
}

void add_whys(const Evaluation& evaluation, const MissedWhys& whys,
              nlohmann::ordered_json& document) {
  for (std::size_t s = 0; s < evaluation.scenes.size(); ++s) {
    const std::vector<std::size_t>& missed = evaluation.scenes[s].missed;
    for (std::size_t k = 0; k < missed.size(); ++k) {
      const auto why = whys.find({s, missed[k]});
      if (why != whys.end()) document["scenes"][s]["missed"][k]["why"] = why->second;
    }
  }
}

}  // namespace trivet::apps
