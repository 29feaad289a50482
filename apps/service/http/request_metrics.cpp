#include "apps/service/http/request_metrics.hpp"

#include <prometheus/gauge.h>
#include <prometheus/text_serializer.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "apps/service/http/process_metrics.hpp"

namespace trivet::apps::service {
namespace {

const prometheus::Histogram::BucketBoundaries kDurationBounds{
    0.005, 0.01, 0.025, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1, 2, 5, 10, 60};

}  // namespace

RequestMetrics::RequestMetrics()
    : requests_(counters("trivet_requests_total", "Requests answered.")),
      refused_(counters("trivet_refused_total", "Requests refused for who asked, or for how.")),
      request_(duration_of(durations("trivet_request_duration_seconds",
                                     "From a request's arrival to its answer, recognitions only."),
                           {})) {
  prometheus::BuildGauge()
      .Name("trivet_build_info")
      .Help("The program.")
      .Register(registry_)
      .Add({{"version", TRIVET_VERSION}})
      .Set(1);
  for (const std::string_view fault : kAccessFaults) refused_.Add({{"reason", std::string(fault)}});
}

void RequestMetrics::expect_requests(const std::string& route, std::span<const unsigned> codes) {
  for (const unsigned code : codes)
    requests_.Add({{"route", route}, {"code", std::to_string(code)}});
}

void RequestMetrics::count_request(const std::string& route, unsigned code) {
  requests_.Add({{"route", route}, {"code", std::to_string(code)}}).Increment();
}

void RequestMetrics::count_refused(AccessFault fault) {
  refused_.Add({{"reason", std::string(name_of(fault))}}).Increment();
}

void RequestMetrics::observe_request(double seconds) { request_.Observe(seconds); }

Counters& RequestMetrics::counters(const std::string& name, const std::string& help) {
  return prometheus::BuildCounter().Name(name).Help(help).Register(registry_);
}

Durations& RequestMetrics::durations(const std::string& name, const std::string& help) {
  return prometheus::BuildHistogram().Name(name).Help(help).Register(registry_);
}

HttpResponse RequestMetrics::response(std::vector<prometheus::MetricFamily> now) const {
  std::vector<prometheus::MetricFamily> all = registry_.Collect();
  for (prometheus::MetricFamily& family : all) {
    // The registry orders series by their hash, and labels by name: code before route.
    for (prometheus::ClientMetric& metric : family.metric) std::ranges::reverse(metric.label);
    std::ranges::sort(family.metric,
                      [](const auto& a, const auto& b) { return a.label < b.label; });
  }
  std::ranges::move(now, std::back_inserter(all));
  std::ranges::move(process_metrics(), std::back_inserter(all));
  return {200, prometheus::TextSerializer().Serialize(all), "text/plain; version=0.0.4", {}};
}

prometheus::Histogram& duration_of(Durations& durations, const prometheus::Labels& labels) {
  return durations.Add(labels, kDurationBounds);
}

prometheus::MetricFamily gauge_now(std::string name, std::string help, std::size_t value) {
  prometheus::ClientMetric metric;
  metric.gauge.value = static_cast<double>(value);
  return {std::move(name), std::move(help), prometheus::MetricType::Gauge, {std::move(metric)}};
}

prometheus::MetricFamily counter_now(std::string name, std::string help, std::uint64_t value) {
  prometheus::ClientMetric metric;
  metric.counter.value = static_cast<double>(value);
  return {std::move(name), std::move(help), prometheus::MetricType::Counter, {std::move(metric)}};
}

}  // namespace trivet::apps::service
