/// Detections as one JSON document.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/recognition/output.hpp"
#include "apps/recognition/recognize_request.hpp"

namespace trivet::apps {

/// The document is {"library", "calibration", "scenes", "cameras"}. It is written at the end.
class JsonOutput : public Output {
 public:
  using Json = nlohmann::ordered_json;

  /// file     "-" stands for standard output
  /// library  as named on the command line
  /// request  outlives the output
  JsonOutput(std::string file, const std::string& library, const RecognitionRequest& request);

  Result<void> add(const RecognizedScene& scene) override;
  void add_failed(const SceneInput& scene, const Error& error) override;
  Result<void> finish() override;

  /// Makes an element of "scenes". This process adds it, or sends it to the process that does.
  static Json element(const SceneInput& scene, const SceneResult& reported,
                      const RecognitionRequest& request);
  /// Adds an element made by element().
  ///
  /// check  of the scene's camera, if there was any
  void add_element(Json element, const std::optional<CameraCheck>& check);

 private:
  const std::string file_;
  const RecognitionRequest& request_;
  Json document_;
  std::vector<CameraCheck> camera_checks_;
};

}  // namespace trivet::apps
