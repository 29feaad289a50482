/// How the inferences of a library went.
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

/// Where the time of an inference went [s].
struct InferenceSeconds {
  double total = 0;   ///< from the request to its answer
  double queue = 0;   ///< until it was begun
  double input = 0;   ///< to read it
  double infer = 0;   ///< to recognize
  double output = 0;  ///< to write the answer
};

/// All members may be called from any thread. Those of a library are forgotten once one of the next
/// generation was counted.
class InferenceStatistics {
 public:
  void count_success(std::uint64_t generation, const InferenceSeconds& seconds);
  void count_failure(std::uint64_t generation, double seconds);

  nlohmann::ordered_json json(const std::string& model, std::uint64_t generation) const;

 private:
  /// How often, and how long in all.
  struct Sum {
    std::uint64_t count = 0;
    std::chrono::nanoseconds time{0};

    void add(double seconds);
    nlohmann::ordered_json json() const;
  };
  struct Sums {
    std::uint64_t generation = 0, last_ms = 0;  ///< last_ms: of the last inference, Unix time
    Sum success, fail, queue, input, infer, output;
  };
  /// Those of a generation, unless a later one was counted. Pre: locked.
  Sums* sums_of(std::uint64_t generation);

  mutable std::mutex mutex_;
  Sums sums_;
};

}  // namespace trivet::apps::service
