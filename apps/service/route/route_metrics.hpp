/// Counters and histograms of the router.
#pragma once

#include <span>
#include <string>

#include "apps/service/http/request_metrics.hpp"
#include "apps/service/route/shard.hpp"

namespace trivet::apps::service {

/// All members may be called from any thread.
class RouteMetrics : public RequestMetrics {
 public:
  RouteMetrics();
  /// Tell of a shard before it is asked.
  void expect_shard(const std::string& shard);
  /// outcome  answered, refused, deadline, unreachable, broken or gone
  void observe_shard(const std::string& shard, const std::string& outcome, double seconds);

  /// What is now, told with the counters.
  struct Gauges {
    std::size_t inflight = 0, inflight_bytes = 0;
  };
  HttpResponse tell(const Gauges& gauges, std::span<const Shard> shards) const;

 private:
  Counters& shard_requests_;
  Durations& shards_;
};

}  // namespace trivet::apps::service
