/// Counters and histograms of a service, in the Prometheus text format.
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

/// One counter for each combination of label values.
using Counters = prometheus::Family<prometheus::Counter>;
using Durations = prometheus::Family<prometheus::Histogram>;

/// Metrics that all requests have in common. Other metrics are added to the same registry. All
/// members may be called from any thread.
class RequestMetrics {
 public:
  RequestMetrics();
  /// Creates the series of expected requests in advance: rates of a series that first appears with
  /// a count would miss that count.
  void expect_requests(const std::string& route, std::span<const unsigned> codes);
  void count_request(const std::string& route, unsigned code);
  void count_refused(AccessFault fault);
  void observe_request(double seconds);  ///< time from the arrival of a recognition to its response

 protected:
  ~RequestMetrics() = default;
  Counters& counters(const std::string& name, const std::string& help);
  Durations& durations(const std::string& name, const std::string& help);
  /// The response with all counters, and with the current metrics of the service and of the
  /// process.
  HttpResponse response(std::vector<prometheus::MetricFamily> now) const;

 private:
  prometheus::Registry registry_;
  Counters &requests_, &refused_;
  prometheus::Histogram& request_;
};

/// The histogram with these labels, from five milliseconds to a minute.
prometheus::Histogram& duration_of(Durations& durations, const prometheus::Labels& labels);

/// Status codes that any route may answer with.
inline constexpr std::array<unsigned, 3> kUsualCodes{200, 400, 404};
inline constexpr std::array<unsigned, 3> kCodesOfOthers{400, 404, 405};
inline constexpr std::array<unsigned, 7> kCodesOfWork{200, 400, 404, 499, 500, 503, 504};

/// A gauge and a counter whose values are kept elsewhere.
prometheus::MetricFamily gauge_now(std::string name, std::string help, std::size_t value);
prometheus::MetricFamily counter_now(std::string name, std::string help, std::uint64_t value);

}  // namespace trivet::apps::service
