#include "apps/service/route/route_metrics.hpp"

#include <utility>

namespace trivet::apps::service {

RouteMetrics::RouteMetrics()
    : shard_requests_(counters("trivet_shard_requests_total", "Recognitions asked of shards.")),
      shards_(durations("trivet_shard_request_duration_seconds",
                        "Until a shard answered, or failed to.")) {
  expect_requests("recognize", kCodesOfWork);
  for (const char* const route : {"models", "live", "ready", "metrics"})
    expect_requests(route, kUsualCodes);
  expect_requests("other", kCodesOfOthers);
}

void RouteMetrics::expect_shard(const std::string& shard) {
  for (const char* const outcome :
       {"answered", "refused", "deadline", "unreachable", "broken", "gone"})
    shard_requests_.Add({{"shard", shard}, {"outcome", outcome}});
  duration_of(shards_, {{"shard", shard}});
}

void RouteMetrics::observe_shard(const std::string& shard, const std::string& outcome,
                                 double seconds) {
  shard_requests_.Add({{"shard", shard}, {"outcome", outcome}}).Increment();
  duration_of(shards_, {{"shard", shard}}).Observe(seconds);
}

HttpResponse RouteMetrics::tell(const Gauges& gauges, std::span<const Shard> shards) const {
  std::vector<prometheus::ClientMetric> ready;
  for (const Shard& shard : shards) {
    prometheus::ClientMetric& one = ready.emplace_back();
    one.label = {{"shard", shard.address.name}};
    one.gauge.value = shard.is_ready ? 1 : 0;
  }
  return RequestMetrics::tell({
      gauge_now("trivet_shard_ready", "Whether a shard was ready when last looked at.",
                std::move(ready)),
      gauge_now("trivet_inflight", "Recognitions that run.", gauges.inflight),
      gauge_now("trivet_queue_bytes", "Of recognitions that run.", gauges.inflight_bytes),
  });
}

}  // namespace trivet::apps::service
