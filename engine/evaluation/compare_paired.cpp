#include "engine/evaluation/compare_paired.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/common/counter_random.hpp"
#include "kernels/common/quantile.hpp"

namespace trivet {
namespace {

constexpr std::size_t kNumResamples = 2000;
constexpr std::uint64_t kResampling = 0x626F;  // stream of random numbers

double difference_of(const PairedTrials& trials) noexcept {
  const std::size_t n = trials.num_trials();
  const double lead =
      static_cast<double>(trials.only_first) - static_cast<double>(trials.only_second);
  return n == 0 ? 0 : lead / static_cast<double>(n);
}

/// Probability that, of `n` fair coins, at most `k` or at least n - k show one side; k <= n / 2.
double two_sided_tail(std::size_t k, std::size_t n) noexcept {
  // The probability of exactly k, as a logarithm since 2^n may overflow a double.
  double log_chance = -static_cast<double>(n) * std::numbers::ln2;
  for (std::size_t i = 1; i <= k; ++i)
    log_chance += std::log(static_cast<double>(n - k + i) / static_cast<double>(i));
  // Probabilities of k - 1, k - 2 ... relative to that of k, each from the previous one.
  double sum = 0, share = 1;
  for (std::size_t i = k; share > 0; --i) {
    sum += share;
    share *= static_cast<double>(i) / static_cast<double>(n - i + 1);
  }
  return std::min(1.0, 2 * std::exp(log_chance) * sum);
}

}  // namespace

PairedTrials& PairedTrials::operator+=(const PairedTrials& other) noexcept {
  both += other.both;
  only_first += other.only_first;
  only_second += other.only_second;
  neither += other.neither;
  return *this;
}

PairedComparison compare_paired(std::span<const PairedTrials> scenes, std::uint64_t seed) {
  PairedComparison out;
  for (const PairedTrials& scene : scenes) out.total += scene;
  out.difference = difference_of(out.total);
  if (scenes.empty()) return out;

  std::vector<double> differences(kNumResamples);
  for (std::size_t r = 0; r < kNumResamples; ++r) {
    kernels::CounterRandom random(seed, kResampling, r);
    PairedTrials drawn;
    for (std::size_t i = 0; i < scenes.size(); ++i)
      drawn +=
          scenes[static_cast<std::size_t>(random.uniform(0, static_cast<double>(scenes.size())))];
    differences[r] = difference_of(drawn);
  }
  out.low = *kernels::quantile(differences, 0.025);
  out.high = *kernels::quantile(std::move(differences), 0.975);

  const auto [fewer, more] = std::minmax(out.total.only_first, out.total.only_second);
  out.p = two_sided_tail(fewer, fewer + more);
  return out;
}

}  // namespace trivet
