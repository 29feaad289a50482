#include "engine/estimate_camera.hpp"

#include <utility>

namespace trivet {
namespace {

constexpr int kMostCorrections = 2;

/// Whether any camera was off, and so was corrected in its scenes.
bool correct_cameras(std::span<const SceneResult> results, std::span<SceneInput> scenes) {
  std::vector<CameraCheck> checks;
  for (const SceneResult& result : results) {
    if (result.stats.camera_check) checks.push_back(*result.stats.camera_check);
  }
  bool any = false;
  for (const CameraCheck& check : join_checks(checks)) {
    const std::optional<Camera> corrected = corrected_camera(check);
    if (!corrected) continue;
    any = true;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const std::optional<CameraCheck>& own = results[s].stats.camera_check;
      if (own && own->camera == check.camera) scenes[s].camera = corrected;
    }
  }
  return any;
}

}  // namespace

Result<std::vector<SceneResult>> recognize_estimating_camera(const Recognizer& recognizer,
                                                             std::span<SceneInput> scenes,
                                                             const RecognizeOptions& options,
                                                             const Progress& progress) {
  for (int corrections = 0;; ++corrections) {
    std::vector<SceneResult> results;
    const Result<void> done =
        recognize_all(recognizer, scenes, options, progress,
                      [&](std::size_t, const SceneResult& result) { results.push_back(result); });
    if (!done) return done.error();
    if (corrections == kMostCorrections || !correct_cameras(results, scenes)) return results;
  }
}

}  // namespace trivet
