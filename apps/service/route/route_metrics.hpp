/// Counters and histograms of the router. Used on one thread.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "apps/service/http/prometheus.hpp"
#include "apps/service/route/shard.hpp"

namespace trivet::apps::service {

class RouteMetrics {
 public:
  void count_request(const std::string& route, unsigned code);
  void observe_request(double seconds);
  /// outcome  answered, refused, deadline, unreachable, broken or gone
  void observe_shard(const std::string& shard, const std::string& outcome, double seconds);

  /// What is now, told with the counters.
  struct Gauges {
    std::size_t inflight = 0, inflight_bytes = 0;
  };
  std::string text(const Gauges& gauges, std::span<const Shard> shards) const;

 private:
  std::map<std::pair<std::string, unsigned>, std::uint64_t> requests_;
  std::map<std::pair<std::string, std::string>, std::uint64_t> shard_requests_;
  std::map<std::string, Histogram> shards_;
  Histogram request_;
};

}  // namespace trivet::apps::service
