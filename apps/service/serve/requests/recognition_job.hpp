/// Jobs that recognize the scans of a request, and their responses.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/service/serve/requests/metrics.hpp"
#include "apps/service/serve/requests/scan_request.hpp"
#include "engine/recognition/recognition_service.hpp"

namespace trivet::apps::service {

struct Recognition {
  explicit Recognition(ScanRequest asked)
      : request(std::move(asked)), results(request.scans.size()), failures(request.scans.size()) {}

  ScanRequest request;
  // Indexed by scan; valid once the job is done.
  std::vector<SceneResult> results;
  std::vector<std::optional<Error>> failures;  ///< errors of single scans, if there are several
};

/// A job with one part per scan. A scan that cannot be read or recognized fails the job if it is
/// the only one; with several scans, each keeps its own error. `metrics` outlives the job.
ServiceJob recognition_job(const std::shared_ptr<Recognition>& recognition, Metrics& metrics);

/// The response to the client once the job is done.
/// Errors: every scan failed, as reported by failed_scenes.
Result<nlohmann::ordered_json> recognition_json(const Recognition& done,
                                                const ServiceAnswer& answer,
                                                const std::string& request_id);

}  // namespace trivet::apps::service
