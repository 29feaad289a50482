/// Detections as a page with pictures.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/program/context.hpp"
#include "apps/recognition/output.hpp"
#include "apps/recognition/recognize_request.hpp"

namespace trivet::apps {

/// The page is drawn when all scenes are known.
class ReportOutput : public Output {
 public:
  /// request, context  outlive the output
  ReportOutput(std::string folder, const RecognitionRequest& request, const Context& context)
      : folder_(std::move(folder)), request_(request), context_(context) {}

  Result<void> add(const RecognizedScene& scene) override;
  Result<void> finish() override;

 private:
  const std::string folder_;
  const RecognitionRequest& request_;
  const Context& context_;
  std::vector<SceneInput> scenes_;
  std::vector<SceneResult> results_;  // one per scene
};

}  // namespace trivet::apps
