#include "engine/recognition/estimate_camera.hpp"

#include <utility>

namespace trivet {
namespace {

constexpr int kMostCorrections = 2;

using Results = std::vector<Result<SceneResult>>;

const std::optional<CameraCheck>& check_of(const Result<SceneResult>& result) {
  static const std::optional<CameraCheck> kNone;
  return result ? result->stats.camera_check : kNone;
}

/// Correct the cameras that are off in their scenes. Returns whether there were any.
bool correct_cameras(const Results& results, std::span<SceneInput> scenes) {
  std::vector<CameraCheck> checks;
  for (const Result<SceneResult>& result : results) {
    if (check_of(result)) checks.push_back(*check_of(result));
  }
  bool any = false;
  for (const CameraCheck& check : join_checks(checks)) {
    const std::optional<Camera> corrected = corrected_camera(check);
    if (!corrected) continue;
    any = true;
    for (std::size_t s = 0; s < scenes.size(); ++s) {
      const std::optional<CameraCheck>& own = check_of(results[s]);
      if (own && own->camera == check.camera) scenes[s].camera = corrected;
    }
  }
  return any;
}

}  // namespace

Result<Results> recognize_estimating_camera(const Recognizer& recognizer,
                                            std::span<SceneInput> scenes,
                                            const RecognizeOptions& options,
                                            const Progress& progress) {
  for (int corrections = 0;; ++corrections) {
    Results results;
    const Result<void> done = recognize_all(
        recognizer, scenes, options, progress,
        [&](std::size_t, const SceneResult& result) { results.emplace_back(result); },
        [&](std::size_t, const Error& error) { results.emplace_back(error); });
    if (!done) return done.error();
    if (corrections == kMostCorrections || !correct_cameras(results, scenes)) return results;
  }
}

}  // namespace trivet
