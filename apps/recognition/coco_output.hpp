/// Detections as a file of masks and boxes in images.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/recognition/output.hpp"
#include "apps/recognition/recognize_request.hpp"
#include "storage/datasets/coco.hpp"

namespace trivet::apps {

class CocoOutput : public Output {
 public:
  /// request  outlives the output
  /// Pre: check_bop_ids.
  CocoOutput(std::string file, const RecognitionRequest& request)
      : file_(std::move(file)), request_(request) {}

  Result<void> add(const RecognizedScene& scene) override;
  Result<void> finish() override;

 private:
  const std::string file_;
  const RecognitionRequest& request_;
  std::vector<CocoResult> results_;
};

}  // namespace trivet::apps
