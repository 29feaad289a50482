#include "apps/service/serve/requests/recognition_job.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include "apps/inputs/open_recognizer.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/failed_scenes.hpp"
#include "apps/words/recognition_text.hpp"
#include "storage/common/wait_for_memory.hpp"

namespace trivet::apps::service {

namespace {

Result<SceneResult> recognize_scan(const ScanPart& scan, const RecognizeOptions& options,
                                   const LibraryGeneration& generation, const std::stop_token& stop,
                                   Metrics& metrics) {
  const LengthUnit unit = generation.recognizer.library().header.unit;
  const auto begun = ServiceClock::now();
  const Result<Cloud> cloud =
      read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene, unit);
  if (!cloud) return cloud.error();
  metrics.observe_stage("decode",
                        std::chrono::duration<double>(ServiceClock::now() - begun).count());
  SceneInput input = scan.scene.input(unit);
  input.file = scan.name;  // shown in errors
  return trivet::recognize(generation.recognizer, *cloud, input, options, stop);
}

/// Whether the error is a fault of the client's data. All other errors (no memory, a changed
/// library) may disappear on retry.
bool is_of_scan(const Error& error) {
  return error.code == ErrorCode::bad_data || error.code == ErrorCode::usage;
}

nlohmann::ordered_json advice_json(const ScanPart& scan, const SceneResult& result,
                                   const RecognizeOptions& options, const Library& library) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  const SceneInput input = scan.scene.input(library.header.unit);
  for (const Advice& advice : advice_on_nothing(input, result, library, options.min_score))
    json.push_back({{"about", advice.about}, {"words", advice.words}});
  return json;
}

/// The scene of a response: that of `trivet recognize --json`, with advice if nothing was found.
nlohmann::ordered_json answered_scene_json(const ScanPart& scan, const SceneResult& result,
                                           const RecognizeOptions& options,
                                           const Recognizer& recognizer) {
  nlohmann::ordered_json json = scene_json(scan.name, result, recognizer.score(), options);
  if (result.detections.empty())
    json["advice"] = advice_json(scan, result, options, recognizer.library());
  return json;
}

}  // namespace

ServiceJob recognition_job(const std::shared_ptr<Recognition>& recognition, Metrics& metrics) {
  ServiceJob job;
  job.num_parts = recognition->request.scans.size();
  for (const ScanPart& scan : recognition->request.scans) {
    job.part_bytes =
        std::max(job.part_bytes, scan_bytes(std::as_bytes(std::span(scan.bytes)), scan.name));
  }
  job.work = [&metrics, recognition](std::size_t i, const LibraryGeneration& generation,
                                     const std::stop_token& stop) -> Result<void> {
    const FailWithoutMemory scope;
    const ScanRequest& request = recognition->request;
    Result<SceneResult> result =
        recognize_scan(request.scans[i], request.options, generation, stop, metrics);
    if (result) {
      recognition->results[i] = std::move(*result);
    } else if (request.scans.size() > 1 && is_of_scan(result.error())) {
      recognition->failures[i] = result.error();
    } else {
      return result.error();
    }
    return {};
  };
  return job;
}

Result<nlohmann::ordered_json> recognition_json(const Recognition& done,
                                                const ServiceAnswer& answer,
                                                const std::string& request_id) {
  std::vector<Error> failures;
  for (const std::optional<Error>& failure : done.failures)
    if (failure) failures.push_back(*failure);
  const std::size_t num_scenes = done.results.size();
  if (failures.size() == num_scenes) return failed_scenes(failures, num_scenes).error();
  const Recognizer& recognizer = answer.generation->recognizer;
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < num_scenes; ++i) {
    const ScanPart& scan = done.request.scans[i];
    scenes.push_back(done.failures[i] ? failed_scene_json(scan.name, *done.failures[i])
                                      : answered_scene_json(scan, done.results[i],
                                                            done.request.options, recognizer));
  }
  return nlohmann::ordered_json{
      {"request_id", request_id},
      {"library",
       {{"file", recognizer.library().file.filename().string()},
        {"generation", answer.generation->number},
        {"calibration", calibration_json(recognizer)}}},
      {"seconds", {{"queue", answer.queue_seconds}, {"work", answer.work_seconds}}},
      {"scenes", std::move(scenes)}};
}

}  // namespace trivet::apps::service
