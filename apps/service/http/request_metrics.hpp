/// Counters and histograms of a service, told in Prometheus' text format.
#pragma once

#include <prometheus/counter.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

/// One for each value of the labels that was seen.
using Counters = prometheus::Family<prometheus::Counter>;
using Durations = prometheus::Family<prometheus::Histogram>;

/// What every service counts of its requests; it counts the rest in the same registry. All members
/// may be called from any thread.
class RequestMetrics {
 public:
  RequestMetrics();
  void count_request(const std::string& route, unsigned code);
  void observe_request(double seconds);  ///< from its arrival to its answer; recognitions only

 protected:
  ~RequestMetrics() = default;
  Counters& counters(const std::string& name, const std::string& help);
  Durations& durations(const std::string& name, const std::string& help);
  /// What was counted, and what is only read when somebody asks.
  HttpResponse tell(std::vector<prometheus::MetricFamily> now) const;

 private:
  prometheus::Registry registry_;
  Counters& requests_;
  prometheus::Histogram& request_;
};

/// The one with these labels, from five milliseconds to a minute.
prometheus::Histogram& duration_of(Durations& durations, const prometheus::Labels& labels);

/// A gauge of as many values as are told.
prometheus::MetricFamily gauge_now(std::string name, std::string help,
                                   std::vector<prometheus::ClientMetric> values);
prometheus::MetricFamily gauge_now(std::string name, std::string help, std::size_t value);
/// A counter that is kept elsewhere.
prometheus::MetricFamily counter_now(std::string name, std::string help, std::uint64_t value);

}  // namespace trivet::apps::service
