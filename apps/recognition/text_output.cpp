#include "apps/recognition/text_output.hpp"

#include "apps/results/standard_output.hpp"
#include "apps/words/explanation_words.hpp"
#include "apps/words/recognition_text.hpp"

namespace trivet::apps {

Result<void> TextOutput::add(const RecognizedScene& scene) {
  const Recognizer& recognizer = request_.recognizer;
  const SceneResult& result = scene.reported;
  if (result.stats.camera_check) camera_checks_.push_back(*result.stats.camera_check);
  return write_output(
      scene_text(scene.input, result, recognizer.library(), request_.options.min_score) +
      explanation_text(result, recognizer.score(), request_.options));
}

Result<void> TextOutput::finish() {
  for (const CameraCheck& check : join_checks(camera_checks_)) {
    TRIVET_TRY(write_output(camera_text(check)));
  }
  return {};
}

}  // namespace trivet::apps
