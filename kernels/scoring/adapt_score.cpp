#include "kernels/scoring/adapt_score.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

// With smaller ones, five scans change too little; with larger ones, they are overrated.
constexpr double kShiftDeviation = 0.5, kWeightDeviation = 0.7;
constexpr int kMaxPasses = 400;
constexpr double kConverged = 1e-5;  // largest step of a pass, in standard deviations
constexpr int kTollBisections = 16;

/// Rows of the fit: log odds, and the cost of each part.
struct Costs {
  std::vector<double> log_odds;
  std::array<std::vector<double>, kNumScoreParts> parts;
  std::vector<std::uint8_t> right;
};

double log_odds_of(const ScoreModel& model, const ScoreParts& parts) noexcept {
  const std::array<float, 2> shares = sensor_shares(parts);
  double sum = static_cast<double>(shares[0] * model.bias[0] + shares[1] * model.bias[1]);
  for (std::size_t part = 0; part < kNumScoreParts; ++part)
    sum += static_cast<double>(part_evidence(model, parts, part));
  return sum;
}

/// In an order that the rows alone determine, so that sums do not depend on the input order.
Costs costs_of(const ScoreModel& model, std::span<const ScoreParts> parts,
               std::span<const std::uint8_t> right) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return right[a] != right[b] ? right[a] < right[b] : parts[a] < parts[b];
  });
  Costs costs;
  for (const std::size_t i : order) {
    costs.log_odds.push_back(log_odds_of(model, parts[i]));
    costs.right.push_back(right[i]);
    const std::array<float, 2> shares = sensor_shares(parts[i]);
    for (std::size_t part = 0; part < kNumScoreParts; ++part) {
      const std::array<float, 2> most = most_evidence(model, part);
      const float cost =
          shares[0] * most[0] + shares[1] * most[1] - part_evidence(model, parts[i], part);
      costs.parts[part].push_back(static_cast<double>(std::max(cost, 0.0F)));
    }
  }
  return costs;
}

/// One unknown: the change of each row's log odds with it, and the state of coordinate descent.
struct Coordinate {
  std::vector<double> slopes;
  double value = 0, center = 0, deviation = 1, low = 0, high = 0;
  double raise = 0;  // derivative of the largest raise: by the shift, or by a weight below 1
  double trust = 1;  // largest step
};

/// The minimum of a parabola with this slope and curvature at c.value plus the penalty on raises.
double lowest_point(const Coordinate& c, double gradient, double curvature, double toll) {
  const double paid = toll * c.raise / curvature, free = c.value - gradient / curvature;
  if (c.center == 0) return free - paid;
  return free < c.center ? std::min(free + paid, c.center) : free;
}

/// The largest curvature of the log loss if log odds change by at most `reach`.
double largest_curvature(double log_odds, double reach) {
  const double beyond = std::abs(log_odds) - reach;
  return beyond <= 0 ? 0.25 : 1 / (2 + std::exp(beyond) + std::exp(-beyond));
}

/// One step along a coordinate, within its trust region and its bounds, that cannot overshoot.
/// Returns the step.
double descend_along(Coordinate& c, std::span<const std::uint8_t> right, double toll,
                     std::span<double> log_odds) {
  const double precision = 1 / (c.deviation * c.deviation);
  double gradient = precision * (c.value - c.center), curvature = precision;
  for (std::size_t i = 0; i < right.size(); ++i) {
    if (c.slopes[i] == 0) continue;
    const double p = 1 / (1 + std::exp(-log_odds[i]));
    gradient += (p - right[i]) * c.slopes[i];
    curvature +=
        largest_curvature(log_odds[i], c.trust * std::abs(c.slopes[i])) * c.slopes[i] * c.slopes[i];
  }
  const double wanted =
      std::clamp(lowest_point(c, gradient, curvature, toll), c.value - c.trust, c.value + c.trust);
  const double step = std::clamp(wanted, c.low, c.high) - c.value;
  c.value += step;
  c.trust = std::max(2 * std::abs(step), c.trust / 2);
  for (std::size_t i = 0; i < right.size(); ++i) log_odds[i] += step * c.slopes[i];
  return std::abs(step) / c.deviation;
}

class AdaptationFit {
 public:
  AdaptationFit(const ScoreModel& model, std::span<const ScoreParts> parts,
                std::span<const std::uint8_t> right)
      : costs_(costs_of(model, parts, right)) {
    coordinates_.push_back(
        {std::vector<double>(parts.size(), 1), 0, 0, kShiftDeviation, -HUGE_VAL, HUGE_VAL, 1});
    for (std::size_t part = 0; part < kNumScoreParts; ++part) {
      std::vector<double> slopes;
      for (const double cost : costs_.parts[part]) slopes.push_back(-cost);
      coordinates_.push_back({std::move(slopes), 1, 1, kWeightDeviation, 0, kMaxCostWeight,
                              static_cast<double>(std::ranges::max(most_evidence(model, part)))});
    }
  }

  /// Minimize with this penalty for each unit of the largest raise.
  ScoreAdaptation minimize(double toll) {
    for (Coordinate& c : coordinates_) c.trust = 1;
    for (int pass = 0; pass < kMaxPasses; ++pass) {
      double largest = 0;
      for (Coordinate& c : coordinates_)
        largest = std::max(largest, descend_along(c, costs_.right, toll, costs_.log_odds));
      if (largest < kConverged) break;
    }
    ScoreAdaptation adaptation;
    adaptation.shift = static_cast<float>(coordinates_[0].value);
    for (std::size_t part = 0; part < kNumScoreParts; ++part)
      adaptation.weights[part] = static_cast<float>(coordinates_[part + 1].value);
    return adaptation;
  }

 private:
  Costs costs_;
  std::vector<Coordinate> coordinates_;
};

}  // namespace

std::array<float, 2> most_evidence(const ScoreModel& model, std::size_t part) noexcept {
  std::array<float, 2> most{};
  for (std::size_t errors = 0; errors < most.size(); ++errors) {
    for (std::size_t k = 0; k + 1 < ScoreModel::kKnots; ++k) {
      if (model.knots[part][k + 1] > model.knots[part][k])
        most[errors] += model.weights[errors][part][k];
    }
  }
  return most;
}

ScoreModel adapted_score(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept {
  ScoreModel adapted = model;
  for (std::size_t errors = 0; errors < adapted.bias.size(); ++errors)
    adapted.bias[errors] += adaptation.shift;
  for (std::size_t part = 0; part < kNumScoreParts; ++part) {
    const float weight = adaptation.weights[part];
    const std::array<float, 2> most = most_evidence(model, part);
    for (std::size_t errors = 0; errors < most.size(); ++errors) {
      adapted.bias[errors] += (1 - weight) * most[errors];
      for (float& ramp : adapted.weights[errors][part]) ramp *= weight;
    }
  }
  return adapted;
}

float largest_raise(const ScoreModel& model, const ScoreAdaptation& adaptation) noexcept {
  // The correlation of errors interpolates both linearly, so that no pose between is raised by
  // more.
  float raise = adaptation.shift;
  for (std::size_t part = 0; part < kNumScoreParts; ++part) {
    raise +=
        std::max(0.0F, 1 - adaptation.weights[part]) * std::ranges::max(most_evidence(model, part));
  }
  return std::max(raise, 0.0F);
}

ScoreAdaptation part_of_the_way(const ScoreAdaptation& adaptation, float share) noexcept {
  ScoreAdaptation part;
  part.shift = share * adaptation.shift;
  for (std::size_t k = 0; k < kNumScoreParts; ++k)
    part.weights[k] = 1 + share * (adaptation.weights[k] - 1);
  return part;
}

ScoreAdaptation fit_adaptation(const ScoreModel& model, std::span<const ScoreParts> parts,
                               std::span<const std::uint8_t> right) {
  TRIVET_REQUIRE(parts.size() == right.size(), "one outcome a row");
  AdaptationFit fit(model, parts, right);
  const ScoreAdaptation unbounded = fit.minimize(0);
  if (largest_raise(model, unbounded) <= kMaxRaise) return unbounded;
  // The smallest penalty that satisfies the bound is the multiplier of the constrained minimum. A
  // penalty of the number of rows exceeds any possible gain.
  ScoreAdaptation best;
  double low = 0, high = static_cast<double>(parts.size());
  for (int i = 0; i < kTollBisections; ++i) {
    const double toll = (low + high) / 2;
    const ScoreAdaptation tried = fit.minimize(toll);
    if (largest_raise(model, tried) > kMaxRaise) {
      low = toll;
    } else {
      high = toll;
      best = tried;
    }
  }
  return best;
}

}  // namespace trivet::kernels
