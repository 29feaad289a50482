#include "kernels/scoring/fit_score.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {
namespace {

constexpr double kLowestShare = 0.03, kHighestShare = 0.97;  // quantiles of the rows for the outer
                                                             // knots
constexpr int kFitPasses = 400;
constexpr double kFitted = 1e-5;  // largest step of a pass, in log odds

std::array<float, ScoreModel::kKnots> knots_of(std::span<const ScoreParts> parts,
                                               std::size_t part) {
  std::vector<float> values;
  values.reserve(parts.size());
  for (const ScoreParts& row : parts) values.push_back(row[part]);
  std::sort(values.begin(), values.end());
  const auto quantile = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  const float low = quantile(kLowestShare), high = quantile(kHighestShare);
  std::array<float, ScoreModel::kKnots> knots;
  for (std::size_t k = 0; k < knots.size(); ++k)
    knots[k] = low + (high - low) * static_cast<float>(k) / static_cast<float>(knots.size() - 1);
  return knots;
}

/// One ramp's values over all rows, and the state of coordinate descent for its weight.
struct FitCoordinate {
  float* weight;
  std::vector<float> ramp;
  bool bounded;      // a weight, not the bias
  double trust = 1;  // largest step
};

std::vector<float> ramp_of(const ScoreModel& model, std::span<const ScoreParts> parts,
                           std::size_t errors, std::size_t part, std::size_t k) {
  ScoreModel unit;  // this ramp alone
  unit.knots = model.knots;
  unit.weights[errors][part][k] = 1;
  std::vector<float> ramp;
  ramp.reserve(parts.size());
  for (const ScoreParts& row : parts) ramp.push_back(part_evidence(unit, row, part));
  return ramp;
}

/// One Newton step along a coordinate, within its trust region. Returns the step.
double fit_along(FitCoordinate& c, std::span<const std::uint8_t> right, double ridge,
                 std::span<double> log_odds) {
  const double weight = static_cast<double>(*c.weight);
  double gradient = c.bounded ? ridge * weight : 0, curvature = c.bounded ? ridge : 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    const double ramp = static_cast<double>(c.ramp[i]);
    if (ramp == 0) continue;
    const double p = 1 / (1 + std::exp(-log_odds[i]));
    gradient += (p - right[i]) * ramp;
    curvature += p * (1 - p) * ramp * ramp;
  }
  if (!(curvature > 0)) return 0;
  double step = std::clamp(-gradient / curvature, -c.trust, c.trust);
  if (c.bounded) step = std::max(step, -weight);
  const auto moved = static_cast<float>(weight + step);
  step = static_cast<double>(moved) - weight;
  *c.weight = moved;
  c.trust = std::max(2 * std::abs(step), c.trust / 2);
  for (std::size_t i = 0; i < right.size(); ++i)
    log_odds[i] += step * static_cast<double>(c.ramp[i]);
  return std::abs(step);
}

}  // namespace

ScoreModel fit_score(std::span<const ScoreParts> parts, std::span<const std::uint8_t> right,
                     double ridge) {
  TRIVET_REQUIRE(parts.size() == right.size() && !parts.empty() && ridge > 0, "one outcome a row");
  ScoreModel model;
  for (std::size_t part = 0; part < kCorrelationPart; ++part)
    model.knots[part] = knots_of(parts, part);
  std::vector<FitCoordinate> coordinates;
  for (std::size_t errors = 0; errors < model.weights.size(); ++errors) {
    std::vector<float> shares;
    for (const ScoreParts& row : parts) shares.push_back(sensor_shares(row)[errors]);
    coordinates.push_back({&model.bias[errors], std::move(shares), false});
    for (std::size_t part = 0; part < kCorrelationPart; ++part) {
      for (std::size_t k = 0; k + 1 < ScoreModel::kKnots; ++k) {
        if (!(model.knots[part][k + 1] > model.knots[part][k])) continue;
        coordinates.push_back(
            {&model.weights[errors][part][k], ramp_of(model, parts, errors, part, k), true});
      }
    }
  }
  std::vector<double> log_odds(parts.size(), 0);
  for (int pass = 0; pass < kFitPasses; ++pass) {
    double largest = 0;
    for (FitCoordinate& c : coordinates)
      largest = std::max(largest, fit_along(c, right, ridge, log_odds));
    if (largest < kFitted) break;
  }
  return model;
}

double log_loss(const ScoreModel& model, std::span<const ScoreParts> parts,
                std::span<const std::uint8_t> right) noexcept {
  double sum = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const double p =
        std::clamp(static_cast<double>(pose_probability(model, parts[i])), 1e-9, 1 - 1e-9);
    sum -= right[i] != 0 ? std::log(p) : std::log(1 - p);
  }
  return sum / static_cast<double>(parts.size());
}

}  // namespace trivet::kernels
