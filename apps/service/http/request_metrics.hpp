/// Counters and histograms of a service, told in Prometheus' text format.
#pragma once

#include <prometheus/counter.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "apps/service/http/access.hpp"
#include "apps/service/http/http_server.hpp"

namespace trivet::apps::service {

/// One for each value of the labels.
using Counters = prometheus::Family<prometheus::Counter>;
using Durations = prometheus::Family<prometheus::Histogram>;

/// What is counted of requests, whatever they ask for; the rest is counted in the same registry. All
/// members may be called from any thread.
class RequestMetrics {
 public:
  RequestMetrics();
  /// Tell of requests that may come before they do: rates of series that appear with their first
  /// count miss it.
  void expect_requests(const std::string& route, std::span<const unsigned> codes);
  void count_request(const std::string& route, unsigned code);
  void count_refused(AccessFault fault);
  void observe_request(double seconds);  ///< from its arrival to its answer; recognitions only

 protected:
  ~RequestMetrics() = default;
  Counters& counters(const std::string& name, const std::string& help);
  Durations& durations(const std::string& name, const std::string& help);
  /// What was counted, and what is only read when somebody asks: of the service, and of the process.
  HttpResponse response(std::vector<prometheus::MetricFamily> now) const;

 private:
  prometheus::Registry registry_;
  Counters &requests_, &refused_;
  prometheus::Histogram& request_;
};

/// The one with these labels, from five milliseconds to a minute.
prometheus::Histogram& duration_of(Durations& durations, const prometheus::Labels& labels);

/// Codes that routes answer with at any time.
inline constexpr std::array<unsigned, 3> kUsualCodes{200, 400, 404};
inline constexpr std::array<unsigned, 3> kCodesOfOthers{400, 404, 405};
inline constexpr std::array<unsigned, 7> kCodesOfWork{200, 400, 404, 499, 500, 503, 504};

/// A gauge and a counter that are kept elsewhere.
prometheus::MetricFamily gauge_now(std::string name, std::string help, std::size_t value);
prometheus::MetricFamily counter_now(std::string name, std::string help, std::uint64_t value);

}  // namespace trivet::apps::service
