/// Detections as lines on standard output, for a person at a terminal.
#pragma once

#include <vector>

#include "apps/recognition/output.hpp"
#include "apps/recognition/recognize_request.hpp"

namespace trivet::apps {

/// Each scene is written as soon as it is added. Findings about the cameras of all scenes come
/// last.
class TextOutput : public Output {
 public:
  /// request  outlives the output
  explicit TextOutput(const RecognitionRequest& request) : request_(request) {}

  Result<void> add(const RecognizedScene& scene) override;
  Result<void> finish() override;

 private:
  const RecognitionRequest& request_;
  std::vector<CameraCheck> camera_checks_;
};

}  // namespace trivet::apps
