#include "apps/serve/metrics.hpp"

#include <fmt/format.h>

#include <iterator>

namespace trivet::apps {
namespace {

void describe(std::string_view name, std::string_view kind, std::string_view help,
              std::string& out) {
  fmt::format_to(std::back_inserter(out), "# HELP {0} {2}\n# TYPE {0} {1}\n", name, kind, help);
}

template <class Value>
void gauge(std::string_view name, std::string_view help, Value value, std::string& out) {
  describe(name, "gauge", help, out);
  fmt::format_to(std::back_inserter(out), "{} {}\n", name, value);
}

}  // namespace

void Metrics::Histogram::observe(double seconds) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += seconds <= kDurationBounds[i];
  ++all;
  sum += seconds;
}

void Metrics::Histogram::write(const std::string& name, const std::string& labels,
                               std::string& out) const {
  const std::string comma = labels.empty() ? "" : labels + ",";
  const std::string braces = labels.empty() ? "" : "{" + labels + "}";
  auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < counts.size(); ++i)
    fmt::format_to(to, "{}_bucket{{{}le=\"{}\"}} {}\n", name, comma, kDurationBounds[i], counts[i]);
  fmt::format_to(to, "{0}_bucket{{{1}le=\"+Inf\"}} {2}\n{0}_sum{3} {4}\n{0}_count{3} {2}\n", name,
                 comma, all, braces, sum);
}

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
  describe("trivet_build_info", "gauge", "The program.", out);
  fmt::format_to(to, "trivet_build_info{{version=\"{}\"}} 1\n", TRIVET_VERSION);
  describe("trivet_requests_total", "counter", "Requests answered.", out);
  for (const auto& [key, n] : requests_) {
    fmt::format_to(to, "trivet_requests_total{{route=\"{}\",code=\"{}\"}} {}\n", key.first,
                   key.second, n);
  }
  describe("trivet_rejected_total", "counter", "Recognitions not done.", out);
  for (const auto& [reason, n] : rejections_)
    fmt::format_to(to, "trivet_rejected_total{{reason=\"{}\"}} {}\n", reason, n);
  describe("trivet_reload_total", "counter", "Libraries read anew.", out);
  for (const auto& [result, n] : reloads_)
    fmt::format_to(to, "trivet_reload_total{{result=\"{}\"}} {}\n", result, n);
  describe("trivet_request_duration_seconds", "histogram",
           "From a request's arrival to its answer, recognitions only.", out);
  request_.write("trivet_request_duration_seconds", "", out);
  describe("trivet_queue_wait_seconds", "histogram", "Of recognitions, before they begin.", out);
  queue_.write("trivet_queue_wait_seconds", "", out);
  describe("trivet_stage_duration_seconds", "histogram", "Of a scene, by stage.", out);
  for (const auto& [stage, histogram] : stages_)
    histogram.write("trivet_stage_duration_seconds", fmt::format("stage=\"{}\"", stage), out);
  gauge("trivet_queue_depth", "Recognitions that wait.", gauges.waiting, out);
  gauge("trivet_inflight", "Recognitions that run.", gauges.running, out);
  gauge("trivet_queue_bytes", "Of recognitions that wait and run.", gauges.queue_bytes, out);
  gauge("trivet_connections", "Open connections.", gauges.connections, out);
  gauge("trivet_library_models", "Models of the library.", gauges.library_models, out);
  gauge("trivet_library_bytes", "Size of the library's file.", gauges.library_bytes, out);
  describe("trivet_log_dropped_total", "counter", "Lines of the log that nobody took.", out);
  fmt::format_to(to, "trivet_log_dropped_total {}\n", gauges.dropped_lines);
  gauge("trivet_library_generation", "Of the library that answers, from 1.", gauges.generation,
        out);
  return out;
}

}  // namespace trivet::apps
