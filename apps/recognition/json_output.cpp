#include "apps/recognition/json_output.hpp"

#include <utility>

#include "apps/results/detections_json.hpp"
#include "apps/results/write_json.hpp"

namespace trivet::apps {

JsonOutput::JsonOutput(std::string file, const std::string& library,
                       const RecognitionRequest& request)
    : file_(std::move(file)),
      request_(request),
      document_{{"library", library},
                {"calibration", calibration_json(request.recognizer)},
                {"scenes", Json::array()},
                {"cameras", Json::array()}} {}

Result<void> JsonOutput::add(const RecognizedScene& scene) {
  add_element(element(scene.input, scene.reported, request_), scene.reported.stats.camera_check);
  return {};
}

void JsonOutput::add_failed(const SceneInput& scene, const Error& error) {
  add_element(failed_scene_json(scene.file.string(), error), {});
}

Result<void> JsonOutput::finish() {
  for (const CameraCheck& check : join_checks(camera_checks_))
    document_["cameras"].push_back(camera_check_json(check));
  return write_json(file_, document_);
}

nlohmann::ordered_json JsonOutput::element(const SceneInput& scene, const SceneResult& reported,
                                           const RecognitionRequest& request) {
  RecognizeOptions options = request.options;
  options.max_rejected = 0;  // rejected poses are in text and report only
  return scene_json(scene.file.string(), reported, request.recognizer.score(), options);
}

void JsonOutput::add_element(Json element, const std::optional<CameraCheck>& check) {
  document_["scenes"].push_back(std::move(element));
  if (check) camera_checks_.push_back(*check);
}

}  // namespace trivet::apps
