#include "apps/service/serve/recognition_job.hpp"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include "apps/inputs/open_recognizer.hpp"
#include "apps/results/detections_json.hpp"
#include "storage/wait_for_memory.hpp"

namespace trivet::apps::service {

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
    const ScanPart& scan = recognition->request.scans[i];
    const LengthUnit unit = generation.recognizer.library().header.unit;
    const auto begun = ServiceClock::now();
    const Result<Cloud> cloud =
        read_scan(std::as_bytes(std::span(scan.bytes)), scan.name, scan.scene, unit);
    if (!cloud) return cloud.error();
    metrics.observe_stage("decode",
                          std::chrono::duration<double>(ServiceClock::now() - begun).count());
    SceneInput input = scan.scene.input(unit);
    input.file = scan.name;  // of which errors speak
    Result<SceneResult> result =
        trivet::recognize(generation.recognizer, *cloud, input, recognition->request.options, stop);
    if (!result) return result.error();
    recognition->results[i] = std::move(*result);
    return {};
  };
  return job;
}

nlohmann::ordered_json recognition_json(const Recognition& done, const ServiceAnswer& answer,
                                        const std::string& request_id) {
  const Recognizer& recognizer = answer.generation->recognizer;
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < done.results.size(); ++i) {
    scenes.push_back(scene_json(done.request.scans[i].name, done.results[i], recognizer.score(),
                                done.request.options));
  }
  return {{"request_id", request_id},
          {"library",
           {{"file", recognizer.library().file.filename().string()},
            {"generation", answer.generation->number},
            {"calibration", calibration_json(recognizer)}}},
          {"seconds", {{"queue", answer.queue_seconds}, {"work", answer.work_seconds}}},
          {"scenes", std::move(scenes)}};
}

}  // namespace trivet::apps::service
