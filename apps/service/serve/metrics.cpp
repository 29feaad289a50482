#include "apps/service/serve/metrics.hpp"

#include <fmt/format.h>

#include <iterator>

namespace trivet::apps::service {
void Metrics::count_request(const std::string& route, unsigned code) {
  const std::lock_guard lock(mutex_);
  ++requests_[{route, code}];
}
void Metrics::count_rejection(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  ++rejections_[reason];
}
void Metrics::count_reload(bool good) {
  const std::lock_guard lock(mutex_);
  ++reloads_[good ? "good" : "bad"];
}
void Metrics::observe_request(double seconds) {
  const std::lock_guard lock(mutex_);
  request_.observe(seconds);
}
void Metrics::observe_queue(double seconds) {
  const std::lock_guard lock(mutex_);
  queue_.observe(seconds);
}
void Metrics::observe_stage(const std::string& stage, double seconds) {
  const std::lock_guard lock(mutex_);
  stages_[stage].observe(seconds);
}

std::string Metrics::text(const Gauges& gauges) const {
  std::string out;
  auto to = std::back_inserter(out);
  const std::lock_guard lock(mutex_);
  describe_metric("trivet_build_info", "gauge", "The program.", out);
  fmt::format_to(to, "trivet_build_info{{version=\"{}\"}} 1\n", TRIVET_VERSION);
  describe_metric("trivet_requests_total", "counter", "Requests answered.", out);
  for (const auto& [key, n] : requests_) {
    fmt::format_to(to, "trivet_requests_total{{route=\"{}\",code=\"{}\"}} {}\n", key.first,
                   key.second, n);
  }
  describe_metric("trivet_rejected_total", "counter", "Recognitions not done.", out);
  for (const auto& [reason, n] : rejections_)
    fmt::format_to(to, "trivet_rejected_total{{reason=\"{}\"}} {}\n", reason, n);
  describe_metric("trivet_reload_total", "counter", "Libraries read anew.", out);
  for (const auto& [result, n] : reloads_)
    fmt::format_to(to, "trivet_reload_total{{result=\"{}\"}} {}\n", result, n);
  describe_metric("trivet_request_duration_seconds", "histogram",
                  "From a request's arrival to its answer, recognitions only.", out);
  request_.write("trivet_request_duration_seconds", "", out);
  describe_metric("trivet_queue_wait_seconds", "histogram", "Of recognitions, before they begin.",
                  out);
  queue_.write("trivet_queue_wait_seconds", "", out);
  describe_metric("trivet_stage_duration_seconds", "histogram", "Of a scene, by stage.", out);
  for (const auto& [stage, histogram] : stages_)
    histogram.write("trivet_stage_duration_seconds", fmt::format("stage=\"{}\"", stage), out);
  write_gauge("trivet_queue_depth", "Recognitions that wait.", gauges.waiting, out);
  write_gauge("trivet_inflight", "Recognitions that run.", gauges.running, out);
  write_gauge("trivet_queue_bytes", "Of recognitions that wait and run.", gauges.queue_bytes, out);
  write_gauge("trivet_connections", "Open connections.", gauges.connections, out);
  write_gauge("trivet_library_models", "Models of the library.", gauges.library_models, out);
  write_gauge("trivet_library_bytes", "Size of the library's file.", gauges.library_bytes, out);
  describe_metric("trivet_log_dropped_total", "counter", "Lines of the log that nobody took.", out);
  fmt::format_to(to, "trivet_log_dropped_total {}\n", gauges.dropped_lines);
  write_gauge("trivet_library_generation", "Of the library that answers, from 1.",
              gauges.generation, out);
  return out;
}

}  // namespace trivet::apps::service
