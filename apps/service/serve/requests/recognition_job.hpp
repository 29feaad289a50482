/// Scans that a service recognizes, and the answer about them.
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
  // By scan, once the job is done.
  std::vector<SceneResult> results;
  std::vector<std::optional<Error>> failures;  ///< what was wrong with a scan, of several
};

/// A part of the job a scan. One that cannot be read or recognized fails the job if it is the only one; of several, each keeps its
/// failure to itself. `metrics` outlives the job.
ServiceJob recognition_job(const std::shared_ptr<Recognition>& recognition, Metrics& metrics);

/// The answer to the client once the job is done. Errors: every scan failed, as failed_scenes has it.
Result<nlohmann::ordered_json> recognition_json(const Recognition& done,
                                                const ServiceAnswer& answer,
                                                const std::string& request_id);

}  // namespace trivet::apps::service
