#include "apps/service/http/prometheus.hpp"

#include <fmt/format.h>

#include <iterator>

namespace trivet::apps::service {

void describe_metric(std::string_view name, std::string_view kind, std::string_view help,
                     std::string& out) {
  fmt::format_to(std::back_inserter(out), "# HELP {0} {2}\n# TYPE {0} {1}\n", name, kind, help);
}

void write_gauge(std::string_view name, std::string_view help, std::size_t value,
                 std::string& out) {
  describe_metric(name, "gauge", help, out);
  fmt::format_to(std::back_inserter(out), "{} {}\n", name, value);
}

void Histogram::observe(double seconds) {
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += seconds <= kDurationBounds[i];
  ++all;
  sum += seconds;
}

void Histogram::write(const std::string& name, const std::string& labels, std::string& out) const {
  const std::string comma = labels.empty() ? "" : labels + ",";
  const std::string braces = labels.empty() ? "" : "{" + labels + "}";
  auto to = std::back_inserter(out);
  for (std::size_t i = 0; i < counts.size(); ++i)
    fmt::format_to(to, "{}_bucket{{{}le=\"{}\"}} {}\n", name, comma, kDurationBounds[i], counts[i]);
  fmt::format_to(to, "{0}_bucket{{{1}le=\"+Inf\"}} {2}\n{0}_sum{3} {4}\n{0}_count{3} {2}\n", name,
                 comma, all, braces, sum);
}

}  // namespace trivet::apps::service
