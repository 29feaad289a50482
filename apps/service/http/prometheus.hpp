/// Prometheus' text format, version 0.0.4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace trivet::apps::service {

/// The lines HELP and TYPE of a metric.
void describe_metric(std::string_view name, std::string_view kind, std::string_view help,
                     std::string& out);
/// A gauge without labels.
void write_gauge(std::string_view name, std::string_view help, std::size_t value, std::string& out);

/// Seconds from five milliseconds to a minute.
inline constexpr std::array<double, 14> kDurationBounds{0.005, 0.01, 0.025, 0.05, 0.1, 0.2, 0.35,
                                                        0.5,   0.75, 1,     2,    5,   10,  60};

struct Histogram {
  std::array<std::uint64_t, kDurationBounds.size()> counts{};
  std::uint64_t all = 0;
  double sum = 0;

  void observe(double seconds);
  /// labels  as a="b",c="d"; may be empty
  void write(const std::string& name, const std::string& labels, std::string& out) const;
};

}  // namespace trivet::apps::service
