#include "kernels/verification/compare_turns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "kernels/symmetry/turn_axis.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180;
constexpr float kStep = 4 * kDegree;  // the hole of a flange is visible over some 5 degrees
constexpr float kFinest = 0.5F * kDegree;
constexpr std::size_t kFewest = 4, kMost = 360;
constexpr double kAsWell = 0.1;

}  // namespace

TurnComparison compare_turns(std::span<const RangeImage> images, const PosedModel& model,
                             const TurnRange& turns, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch) {
  const float period = turns.period;
  const auto log_ratio = [&](float angle) {
    const Pose turned = model.T_scene_model * turn_about(turns.axis, angle);
    return compare_poses(images, {model.surface, model.samples, turned}, model, errors, options,
                         scratch)
        .log_ratio;
  };
  const auto n = clamped_integer(std::round(period / kStep), kFewest, kMost);
  const float step = period / static_cast<float>(n);
  std::vector<float> angles(n);
  std::vector<double> logs(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    angles[k] = static_cast<float>(k) * step;
    if (k > 0) logs[k] = log_ratio(angles[k]);
  }

  const auto best =
      static_cast<std::size_t>(std::max_element(logs.begin(), logs.end()) - logs.begin());
  for (float finer = 0.5F * step; finer >= kFinest; finer *= 0.5F) {
    const float middle = angles[best];
    for (const float angle : {middle - finer, middle + finer}) {
      const double log = log_ratio(angle);
      if (log <= logs[best]) continue;
      logs[best] = log;
      angles[best] = angle;
    }
  }

  std::vector<double> likelihoods(n);
  std::transform(logs.begin(), logs.end(), likelihoods.begin(),
                 [&](double log) { return std::exp(log - logs[best]); });
  TurnComparison out;
  // From the best rotation, extend to both sides while rotations are as likely. If all of them are,
  // there is no middle.
  const auto as_likely = [&](std::size_t k) { return likelihoods[k % n] >= kAsWell; };
  std::size_t after = 0, before = 0;
  while (after < n && as_likely(best + after + 1)) ++after;
  while (before < n && as_likely(best + n - before - 1)) ++before;
  out.best = angles[best];
  out.low = angles[best] - 0.5F * period;
  out.high = angles[best] + 0.5F * period;
  if (after < n) {
    double weights = 0, moments = 0;
    for (std::size_t k = best + n - before; k <= best + n + after; ++k) {
      const double from_best = std::remainder(angles[k % n] - angles[best], period);
      weights += likelihoods[k % n];
      moments += likelihoods[k % n] * from_best;
    }
    out.best = angles[best] + static_cast<float>(moments / weights);
    out.low = angles[best] - static_cast<float>(before) * step;
    out.high = angles[best] + static_cast<float>(after) * step;
  }

  const auto apart = [&](float a, float b) {
    return std::abs(std::remainder(a - b, period)) >= turns.near;
  };
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return logs[a] > logs[b]; });
  double all = 0, close = 0;
  std::vector<float> named{out.best};
  for (const std::size_t k : order) {
    all += likelihoods[k];
    if (!apart(angles[k], out.best)) close += likelihoods[k];
    if (likelihoods[k] < kAsWell ||
        !std::all_of(named.begin(), named.end(), [&](float a) { return apart(a, angles[k]); }))
      continue;
    named.push_back(angles[k]);
    out.others.push_back(angles[k]);
  }
  out.share = static_cast<float>(close / all);
  return out;
}

}  // namespace trivet::kernels
