#include "kernels/scoring/pose_score.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/fitted_score.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using test::fitted_score;

Examination good() {
  Examination e;
  e.covered = 1000;
  e.consistent = 900;
  e.violation = 10;
  e.occluded = 50;
  e.unknown = 40;
  e.outline = 110;
  e.outline_free = 100;
  e.outline_crossed = 2;
  e.residual = 0.05F;
  e.smooth = 0.01F;
  e.slope = 0.05F;
  e.area = 0.4F;
  e.relief = 5;
  e.stability = 0.02F;
  return e;
}

float probability(const Examination& e, float correlation = 0) {
  return pose_probability(fitted_score(), score_parts(e, 0.016F, correlation));
}

TEST(PoseScore, IsAProbability) {
  for (const float correlation : {0.0F, 0.5F, 1.0F}) {
    EXPECT_GT(probability(good(), correlation), 0.5F) << correlation;
    EXPECT_LE(probability(good(), correlation), 1) << correlation;
    EXPECT_GE(probability(Examination{}, correlation), 0) << correlation;
    EXPECT_LT(probability(Examination{}, correlation), 0.05F) << "nothing was seen";
  }
}

TEST(PoseScore, FallsWithWhatSpeaksAgainstAPose) {
  for (const float correlation : {0.0F, 1.0F}) {
    SCOPED_TRACE(correlation);
    const auto worse = [&](auto&& change) {
      Examination e = good();
      change(e);
      return probability(e, correlation);
    };
    const float best = probability(good(), correlation);
    EXPECT_LT(worse([](Examination& e) { e.violation = 300; }), best);
    EXPECT_LT(worse([](Examination& e) { e.background = 300; }), best);
    EXPECT_LT(worse([](Examination& e) { e.outline_crossed = 100; }), best);
    EXPECT_LT(worse([](Examination& e) { e.buried = 100; }), best);
    EXPECT_LT(worse([](Examination& e) { e.stability = 0; }), best);
    EXPECT_LT(worse([](Examination& e) { e.sunk = 600; }), best);
    EXPECT_LT(worse([](Examination& e) { e.relief = 0; }), best);
    EXPECT_LT(worse([](Examination& e) { e.consistent = 30; }), best);
  }
}

TEST(PoseScore, LeavesGapsOut) {
  Examination with_gaps = good();
  with_gaps.covered += 300;
  with_gaps.unknown += 300;
  const float unmeasured = probability(with_gaps);
  with_gaps.gaps = 300;
  EXPECT_GT(probability(with_gaps), unmeasured);
  EXPECT_GE(probability(with_gaps), probability(good()));
}

// For any fit, more of a part never counts against what it indicates.
TEST(PoseScore, IsMonotoneInEachPart) {
  const ScoreModel& model = fitted_score();
  test::Random random(1);
  for (int round = 0; round < 200; ++round) {
    ScoreParts parts;
    for (std::size_t k = 0; k < parts.size(); ++k)
      parts[k] = random.uniform(model.knots[k].front() - 1, model.knots[k].back() + 1);
    parts[kCorrelationPart] = random.uniform(0, 1);
    const float before = pose_probability(model, parts);
    for (std::size_t k = 0; k < kCorrelationPart; ++k) {
      ScoreParts more = parts;
      more[k] += kScoreParts[k].favorable ? 0.3F : -0.3F;
      EXPECT_GE(pose_probability(model, more), before) << kScoreParts[k].name;
    }
  }
}

/// A naive reference for one kind of errors: it walks along the knots.
double log_odds_of(const ScoreModel& model, const ScoreParts& parts, std::size_t errors) {
  double log_odds = static_cast<double>(model.bias[errors]);
  for (std::size_t k = 0; k < parts.size(); ++k) {
    for (std::size_t i = 0; i + 1 < ScoreModel::kKnots; ++i) {
      const double low = static_cast<double>(model.knots[k][i]),
                   high = static_cast<double>(model.knots[k][i + 1]);
      if (high <= low) continue;
      double share = (static_cast<double>(parts[k]) - low) / (high - low);
      share = share < 0 ? 0 : share > 1 ? 1 : share;
      if (!kScoreParts[k].favorable) share = 1 - share;
      log_odds += share * static_cast<double>(model.weights[errors][k][i]);
    }
  }
  return log_odds;
}

TEST(PoseScore, AddsWhatItsPartsSay) {
  const ScoreModel& model = fitted_score();
  const ScoreParts parts = score_parts(good(), 0.016F, 0);
  EXPECT_NEAR(pose_probability(model, parts), 1 / (1 + std::exp(-log_odds_of(model, parts, 0))),
              1e-5);
}

double exact_log_odds(double probability) { return std::log(probability / (1 - probability)); }

// Scans between independent and correlated errors of neighboring pixels.
TEST(PoseScore, MixesBothWeightsByTheCorrelation) {
  test::Random random;
  ScoreModel model;
  for (std::size_t k = 0; k < kCorrelationPart; ++k) {
    for (std::size_t i = 0; i < ScoreModel::kKnots; ++i)
      model.knots[k][i] = static_cast<float>(i) + random.uniform(-0.4F, 0.4F);
    for (ScoreModel::Weights& weights : model.weights) {
      for (float& weight : weights[k]) weight = random.uniform(0, 0.2F);
    }
  }
  model.bias = {-2, -1};
  ScoreModel first = model, second = model;  // that differ in the other weights
  first.bias[1] = second.bias[0] = 7;
  first.weights[1] = model.weights[0];
  second.weights[0] = model.weights[1];
  for (int round = 0; round < 20; ++round) {
    ScoreParts parts;
    for (float& part : parts) part = random.uniform(-0.5F, 4.5F);
    const auto at = [&](const ScoreModel& of, float correlation) {
      parts[kCorrelationPart] = correlation;
      return pose_probability(of, parts);
    };
    EXPECT_EQ(at(model, 0), at(first, 0));
    EXPECT_EQ(at(model, 1), at(second, 1));
    const double independent = log_odds_of(model, parts, 0), shared = log_odds_of(model, parts, 1);
    EXPECT_GT(std::abs(independent - shared), 0.01);
    for (const float correlation : {0.0F, 0.25F, 0.5F, 0.9F, 1.0F}) {
      const double mixed = std::lerp(independent, shared, static_cast<double>(correlation));
      EXPECT_NEAR(exact_log_odds(static_cast<double>(at(model, correlation))), mixed, 1e-4);
    }
  }
}

TEST(PoseScore, HasKnotsThatRiseAndWeightsThatAreNotNegative) {
  const ScoreModel& model = fitted_score();
  for (std::size_t k = 0; k < kNumScoreParts; ++k) {
    for (std::size_t i = 0; i + 1 < ScoreModel::kKnots; ++i) {
      EXPECT_LE(model.knots[k][i], model.knots[k][i + 1]);
      for (const ScoreModel::Weights& weights : model.weights) EXPECT_GE(weights[k][i], 0);
    }
  }
}

TEST(LogOdds, AreBoundedByTheLeastProbability) {
  EXPECT_DOUBLE_EQ(kernels::log_odds(0.5F, 1e-4), 0);
  EXPECT_NEAR(kernels::log_odds(0.75F, 1e-4), std::log(3), 1e-12);
  EXPECT_DOUBLE_EQ(kernels::log_odds(0, 1e-3), -std::log(999.0));
}

}  // namespace
}  // namespace trivet::kernels
