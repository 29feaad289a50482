/// Counters and histograms of the service, in Prometheus' text format.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "apps/service/http/prometheus.hpp"

namespace trivet::apps::service {

/// All members may be called from any thread.
class Metrics {
 public:
  void count_request(const std::string& route, unsigned code);
  void count_rejection(const std::string& reason);
  void count_reload(bool good);
  void observe_request(double seconds);
  void observe_queue(double seconds);
  void observe_stage(const std::string& stage, double seconds);

  /// What is now, told with the counters.
  struct Gauges {
    std::size_t waiting = 0, running = 0, queue_bytes = 0, connections = 0;
    std::size_t library_models = 0, library_bytes = 0;
    std::uint64_t generation = 0, dropped_lines = 0;
  };
  std::string text(const Gauges& gauges) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, unsigned>, std::uint64_t> requests_;
  std::map<std::string, std::uint64_t> rejections_;
  std::map<std::string, std::uint64_t> reloads_;
  std::map<std::string, Histogram> stages_;
  Histogram request_, queue_;
};

}  // namespace trivet::apps::service
