#include "apps/service/route/route_metrics.hpp"

#include <fmt/format.h>

#include <iterator>

namespace trivet::apps::service {

void RouteMetrics::count_request(const std::string& route, unsigned code) {
  ++requests_[{route, code}];
}
void RouteMetrics::observe_request(double seconds) { request_.observe(seconds); }
void RouteMetrics::observe_shard(const std::string& shard, const std::string& outcome,
                                 double seconds) {
  ++shard_requests_[{shard, outcome}];
  shards_[shard].observe(seconds);
}

std::string RouteMetrics::text(const Gauges& gauges, std::span<const Shard> shards) const {
  std::string out;
  auto to = std::back_inserter(out);
  describe_metric("trivet_build_info", "gauge", "The program.", out);
  fmt::format_to(to, "trivet_build_info{{version=\"{}\"}} 1\n", TRIVET_VERSION);
  describe_metric("trivet_requests_total", "counter", "Requests answered.", out);
  for (const auto& [key, n] : requests_) {
    fmt::format_to(to, "trivet_requests_total{{route=\"{}\",code=\"{}\"}} {}\n", key.first,
                   key.second, n);
  }
  describe_metric("trivet_request_duration_seconds", "histogram",
                  "From a request's arrival to its answer, recognitions only.", out);
  request_.write("trivet_request_duration_seconds", "", out);
  describe_metric("trivet_shard_requests_total", "counter", "Recognitions asked of shards.", out);
  for (const auto& [key, n] : shard_requests_) {
    fmt::format_to(to, "trivet_shard_requests_total{{shard=\"{}\",outcome=\"{}\"}} {}\n", key.first,
                   key.second, n);
  }
  describe_metric("trivet_shard_request_duration_seconds", "histogram",
                  "Until a shard answered, or failed to.", out);
  for (const auto& [shard, histogram] : shards_) {
    histogram.write("trivet_shard_request_duration_seconds", fmt::format("shard=\"{}\"", shard),
                    out);
  }
  describe_metric("trivet_shard_ready", "gauge", "Whether a shard was ready when last looked at.",
                  out);
  for (const Shard& shard : shards) {
    fmt::format_to(to, "trivet_shard_ready{{shard=\"{}\"}} {}\n", shard.address.name,
                   shard.is_ready ? 1 : 0);
  }
  write_gauge("trivet_inflight", "Recognitions that run.", gauges.inflight, out);
  write_gauge("trivet_queue_bytes", "Of recognitions that run.", gauges.inflight_bytes, out);
  return out;
}

}  // namespace trivet::apps::service
