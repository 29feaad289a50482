/// Statistics of the inferences of a library.
///
/// Source: Triton's extension of the Open Inference Protocol, statistics.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>

namespace trivet::apps::service {

/// Stages of an inference [s].
struct InferenceSeconds {
  double total = 0;   ///< time from the request to its response
  double queue = 0;   ///< waiting time in the queue
  double input = 0;   ///< time to read the input
  double infer = 0;   ///< time to recognize
  double output = 0;  ///< time to write the response
};

/// All members may be called from any thread. The statistics of a library are dropped once an
/// inference of the next generation was counted.
class InferenceStatistics {
 public:
  void count_success(std::uint64_t generation, const InferenceSeconds& seconds);
  void count_failure(std::uint64_t generation, double seconds);

  nlohmann::ordered_json json(const std::string& model, std::uint64_t generation) const;

 private:
  /// Number of calls and their total time.
  struct Sum {
    std::uint64_t count = 0;
    std::chrono::nanoseconds time{0};

    void add(double seconds);
    nlohmann::ordered_json json() const;
  };
  struct Sums {
    std::uint64_t generation = 0, last_ms = 0;  ///< last_ms: time of the last inference, Unix time
    Sum success, fail, queue, input, infer, output;
  };
  /// The sums of a generation; null if a later one was already counted. Pre: locked.
  Sums* sums_of(std::uint64_t generation);

  mutable std::mutex mutex_;
  Sums sums_;
};

}  // namespace trivet::apps::service
