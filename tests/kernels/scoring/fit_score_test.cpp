#include "kernels/scoring/fit_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string_view>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t part(std::string_view name) {
  std::size_t k = 0;
  while (kScoreParts[k].name != name) ++k;
  return k;
}
constexpr std::size_t kViolation = part("violation"), kStability = part("stability"),
                      kFree = part("free");

struct Rows {
  std::vector<ScoreParts> parts;
  std::vector<std::uint8_t> right;
};

/// Outcomes drawn with log odds that depend on two of the parts; the other parts have no effect.
Rows draw(std::size_t n, std::uint64_t seed) {
  test::Random random(seed);
  Rows rows;
  for (std::size_t i = 0; i < n; ++i) {
    ScoreParts parts;
    for (float& value : parts) value = random.uniform(-1, 1);
    parts[kCorrelationPart] = 0;
    const float log_odds = -2 * parts[kViolation] + 3 * parts[kStability];
    rows.parts.push_back(parts);
    rows.right.push_back(random.uniform(0, 1) < 1 / (1 + std::exp(-log_odds)) ? 1 : 0);
  }
  return rows;
}

std::vector<float> weights_of(const ScoreModel& model) {
  std::vector<float> all;
  for (const ScoreModel::Weights& weights : model.weights) {
    for (const auto& ramps : weights) all.insert(all.end(), ramps.begin(), ramps.end());
  }
  return all;
}

double objective(const ScoreModel& model, const Rows& rows, double ridge) {
  double sum = 0;
  for (std::size_t i = 0; i < rows.parts.size(); ++i) {
    const std::array<float, 2> shares = sensor_shares(rows.parts[i]);
    double z = static_cast<double>(shares[0] * model.bias[0] + shares[1] * model.bias[1]);
    for (std::size_t k = 0; k < kNumScoreParts; ++k)
      z += static_cast<double>(part_evidence(model, rows.parts[i], k));
    sum += std::log1p(std::exp(rows.right[i] != 0 ? -z : z));
  }
  for (const float weight : weights_of(model))
    sum += ridge / 2 * static_cast<double>(weight * weight);
  return sum;
}

TEST(FitScore, EstimatesTheProbabilitiesThatTheOutcomesWereDrawnWith) {
  const Rows rows = draw(8000, 1), fresh = draw(2000, 2);
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  double error = 0;
  for (const ScoreParts& parts : fresh.parts) {
    const float truth = 1 / (1 + std::exp(2 * parts[kViolation] - 3 * parts[kStability]));
    error += static_cast<double>(std::abs(pose_probability(model, parts) - truth));
  }
  EXPECT_LT(error / 2000, 0.03);
  EXPECT_NEAR(log_loss(model, rows.parts, rows.right), log_loss(model, fresh.parts, fresh.right),
              0.03);
}

TEST(FitScore, FindsTheMinimum) {
  const Rows rows = draw(1000, 3);
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  const double least = objective(model, rows, 1);
  for (std::size_t k = 0; k < kCorrelationPart; ++k) {
    for (std::size_t i = 0; i + 1 < ScoreModel::kKnots; ++i) {
      ASSERT_GE(model.weights[0][k][i], 0);
      for (const float step : {-0.02F, 0.02F}) {
        ScoreModel moved = model;
        moved.weights[0][k][i] = std::max(0.0F, moved.weights[0][k][i] + step);
        EXPECT_GE(objective(moved, rows, 1), least - 1e-4) << kScoreParts[k].name << " " << i;
      }
    }
  }
}

float truth_of_two_sensors(const ScoreParts& parts) {
  const float log_odds = std::lerp(-0.5F - 2 * parts[kViolation] + 3 * parts[kStability],
                                   1 + 3 * parts[kFree], parts[kCorrelationPart]);
  return 1 / (1 + std::exp(-log_odds));
}

double log_odds_in_the_middle(const ScoreModel& model, float correlation) {
  ScoreParts parts{};
  parts[kCorrelationPart] = correlation;
  const auto p = static_cast<double>(pose_probability(model, parts));
  return std::log(p / (1 - p));
}

/// Scans with independent pixel errors, where violation and stability are informative, and scans
/// with correlated errors, where the outline is; some scans lie between.
Rows draw_of_two_sensors(std::size_t n, std::uint64_t seed) {
  test::Random random(seed);
  Rows rows;
  for (std::size_t i = 0; i < n; ++i) {
    ScoreParts parts;
    for (float& value : parts) value = random.uniform(-1, 1);
    parts[kCorrelationPart] = std::clamp(random.uniform(-0.5F, 1.5F), 0.0F, 1.0F);
    rows.parts.push_back(parts);
    rows.right.push_back(random.uniform(0, 1) < truth_of_two_sensors(parts) ? 1 : 0);
  }
  return rows;
}

TEST(FitScore, RecoversTheWeightsOfBothKindsOfErrors) {
  const Rows rows = draw_of_two_sensors(12000, 6), fresh = draw_of_two_sensors(2000, 7);
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  double error = 0;
  for (const ScoreParts& parts : fresh.parts)
    error +=
        static_cast<double>(std::abs(pose_probability(model, parts) - truth_of_two_sensors(parts)));
  EXPECT_LT(error / 2000, 0.03);
  const auto sum = [&](std::size_t errors, std::size_t k) {
    const auto& weights = model.weights[errors][k];
    return std::accumulate(weights.begin(), weights.end(), 0.0F);
  };
  // Knots are quantiles from 3 to 97 %, over which slopes of 2 and 3 sum to nearly 4 and 6.
  EXPECT_NEAR(sum(0, kViolation), 4, 0.9F);
  EXPECT_NEAR(sum(0, kStability), 6, 1.2F);
  EXPECT_LT(sum(0, kFree), 0.7F);
  EXPECT_LT(sum(1, kViolation), 0.7F);
  EXPECT_LT(sum(1, kStability), 0.7F);
  EXPECT_NEAR(sum(1, kFree), 6, 1.2F);
  EXPECT_NEAR(log_odds_in_the_middle(model, 0), -0.5, 0.4);
  EXPECT_NEAR(log_odds_in_the_middle(model, 1), 1, 0.4);
}

TEST(FitScore, FindsTheMinimumOfBothWeights) {
  const Rows rows = draw_of_two_sensors(1000, 8);
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  const double least = objective(model, rows, 1);
  for (std::size_t errors = 0; errors < 2; ++errors) {
    for (const std::size_t k : {kViolation, kStability, kFree}) {
      for (std::size_t i = 0; i + 1 < ScoreModel::kKnots; ++i) {
        ASSERT_GE(model.weights[errors][k][i], 0);
        for (const float step : {-0.02F, 0.02F}) {
          ScoreModel moved = model;
          float& weight = moved.weights[errors][k][i];
          weight = std::max(0.0F, weight + step);
          EXPECT_GE(objective(moved, rows, 1), least - 1e-4) << kScoreParts[k].name << " " << i;
        }
      }
    }
    for (const float step : {-0.02F, 0.02F}) {
      ScoreModel moved = model;
      moved.bias[errors] += step;
      EXPECT_GE(objective(moved, rows, 1), least - 1e-4);
    }
  }
}

TEST(FitScore, BoundsWhatDividesAllOutcomes) {
  Rows rows = draw(400, 4);
  for (std::size_t i = 0; i < rows.parts.size(); ++i)
    rows.right[i] = rows.parts[i][kStability] > 0 ? 1 : 0;
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  EXPECT_TRUE(std::isfinite(log_loss(model, rows.parts, rows.right)));
  for (const float weight : weights_of(model)) EXPECT_LT(weight, 50);
}

// A part that should indicate a right pose but occurs with wrong ones gets no weight.
TEST(FitScore, TurnsNoPartAround) {
  Rows rows = draw(2000, 5);
  for (std::size_t i = 0; i < rows.parts.size(); ++i)
    rows.right[i] = rows.parts[i][kStability] < 0 ? 1 : 0;
  const ScoreModel model = fit_score(rows.parts, rows.right, 1);
  for (const float weight : model.weights[0][kStability]) EXPECT_EQ(weight, 0);
}

}  // namespace
}  // namespace trivet::kernels
