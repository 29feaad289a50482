#include "engine/calibration/calibrate_score.hpp"

#include <algorithm>

#include "engine/evaluation/evaluate.hpp"
#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/recognition/recognize.hpp"

namespace trivet {
namespace {

/// Maximum displacement [diameters] and minimum rotation of wrong poses that are left out of the
/// fit. They lie at the place of an object of their model, where near symmetries look alike and
/// compare_poses decides between them. A pose that is displaced farther is wrong.
constexpr double kSamePlace = 0.25, kFlippedDeg = 45;

/// Treat axes of near symmetry as symmetries. The score states whether an object is present, not
/// how it is turned about an axis that its shape hardly determines.
Manifest with_near_axes(Manifest manifest, const Library& library) {
  const auto to_manifest = static_cast<float>(unit_scale(library.header.unit, manifest.unit));
  for (ManifestModel& entry : manifest.models) {
    const auto model = std::ranges::find(library.models, entry.name, &Model::name);
    if (model == library.models.end() || model->symmetry.axis || !model->near_axis) continue;
    if (!entry.symmetry) entry.symmetry = Symmetry{};
    entry.symmetry->axis = *model->near_axis;
    entry.symmetry->axis->point *= to_manifest;
  }
  return manifest;
}

}  // namespace

Result<void> add_outcomes(const Recognizer& recognizer, const Manifest& manifest,
                          RecognizeOptions options, const Progress& progress, Outcomes& outcomes) {
  options.doubtful_score = 0;
  // The score is fitted to the poses before comparison.
  options.ablated.insert(Improvement::alternatives);
  std::vector<std::optional<SceneResult>> results(manifest.scenes.size());
  const Result<void> done = recognize_all(
      recognizer, scenes_of(manifest, recognizer.library().header.unit), options, progress,
      [&](std::size_t index, const SceneResult& result) { results[index] = result; });
  if (!done) return done;
  TRIVET_TRY_ASSIGN(const std::vector<EvaluationMesh> meshes, read_evaluation_meshes(manifest));
  TRIVET_TRY_ASSIGN(const Evaluation judged,
                    evaluate(with_near_axes(manifest, recognizer.library()), meshes, results));
  for (std::size_t s = 0; s < results.size(); ++s) {
    outcomes.scans.push_back(manifest.scenes[s].name);
    for (const JudgedDetection& detection : judged.scenes[s].detections) {
      const bool right = detection.verdict == Verdict::right;
      if (detection.verdict == Verdict::neutral ||
          (!right && detection.translation_error < kSamePlace &&
           detection.rotation_error_deg > kFlippedDeg)) {
        continue;
      }
      outcomes.parts.push_back(results[s]->detections[detection.detection].parts);
      outcomes.right.push_back(right ? 1 : 0);
      outcomes.scan.push_back(static_cast<std::uint32_t>(outcomes.scans.size() - 1));
    }
  }
  return {};
}

}  // namespace trivet
