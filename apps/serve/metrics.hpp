/// Counters and histograms of the service, in Prometheus' text format.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace trivet::apps {

/// Seconds from a millisecond to a minute.
inline constexpr std::array<double, 14> kDurationBounds{0.005, 0.01, 0.025, 0.05, 0.1, 0.2, 0.35,
                                                        0.5,   0.75, 1,     2,    5,   10,  60};

/// All members may be called from any thread.
class Metrics {
 public:
  void count_request(const std::string& route, unsigned code);
  void count_rejection(const std::string& reason);
  void count_reload(bool good);
  void observe_request(double seconds);
  void observe_queue(double seconds);
  void observe_stage(const std::string& stage, double seconds);

  /// What is now, told with the counters.
  struct Gauges {
    std::size_t waiting = 0, running = 0, queue_bytes = 0, connections = 0;
    std::size_t library_models = 0, library_bytes = 0;
    std::uint64_t generation = 0, dropped_lines = 0;
  };
  std::string text(const Gauges& gauges) const;

 private:
  struct Histogram {
    std::array<std::uint64_t, kDurationBounds.size()> counts{};
    std::uint64_t all = 0;
    double sum = 0;
    void observe(double seconds);
    void write(const std::string& name, const std::string& labels, std::string& out) const;
  };
  mutable std::mutex mutex_;
  std::map<std::pair<std::string, unsigned>, std::uint64_t> requests_;
  std::map<std::string, std::uint64_t> rejections_;
  std::map<std::string, std::uint64_t> reloads_;
  std::map<std::string, Histogram> stages_;
  Histogram request_, queue_;
};

}  // namespace trivet::apps
