/// Random numbers that depend on their index only: the same for any number of threads.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace trivet::kernels {

/// A separate short stream for each (seed, stream, item). Source: SplitMix64 (Steele, Lea, Flood,
/// OOPSLA 2014).
class CounterRandom {
 public:
  CounterRandom(std::uint64_t seed, std::uint64_t stream, std::uint64_t item) noexcept
      : state_(mix(mix(mix(seed) + stream) + item)) {}

  std::uint64_t next() noexcept { return mix(state_ += kGamma); }
  /// Uniform in [0, 1).
  double uniform() noexcept { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) noexcept { return low + (high - low) * uniform(); }
  /// Standard normal. Source: Box and Muller, 1958.
  double normal() noexcept {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }

 private:
  static constexpr std::uint64_t kGamma = 0x9E3779B97F4A7C15;
  static std::uint64_t mix(std::uint64_t z) noexcept {
    z += kGamma;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
    return z ^ (z >> 31);
  }

  std::uint64_t state_;
};

}  // namespace trivet::kernels
