/// Scans that a service recognizes, and the answer about them.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/service/serve/metrics.hpp"
#include "apps/service/serve/scan_request.hpp"
#include "engine/recognition_service.hpp"

namespace trivet::apps::service {

struct Recognition {
  explicit Recognition(ScanRequest asked)
      : request(std::move(asked)), results(request.scans.size()) {}

  ScanRequest request;
  std::vector<SceneResult> results;  ///< by scan, once the job is done
};

/// A part of the job a scan. `metrics` outlives the job.
ServiceJob recognition_job(const std::shared_ptr<Recognition>& recognition, Metrics& metrics);

/// What a client is told once the job is done.
nlohmann::ordered_json recognition_json(const Recognition& done, const ServiceAnswer& answer,
                                        const std::string& request_id);

}  // namespace trivet::apps::service
