/// Counters and histograms of the service.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "apps/service/http/request_metrics.hpp"

namespace trivet::apps::service {

/// All members may be called from any thread.
class Metrics : public RequestMetrics {
 public:
  Metrics();
  void count_rejection(const std::string& reason);
  void count_reload(bool good);
  void count_scenes(std::size_t num_recognized, std::size_t num_failed);
  void observe_queue(double seconds);
  void observe_stage(const std::string& stage, double seconds);

  /// Current values.
  struct Gauges {
    std::size_t waiting = 0, running = 0, queue_bytes = 0, connections = 0;
    std::size_t library_models = 0, library_bytes = 0, library_changed = 0;
    std::uint64_t generation = 0, dropped_lines = 0;
  };
  /// The response with all counters and these values, in the Prometheus format.
  HttpResponse response(const Gauges& gauges) const;

 private:
  Counters &rejections_, &reloads_, &scenes_;
  Durations& stages_;
  prometheus::Histogram& queue_;
};

}  // namespace trivet::apps::service
