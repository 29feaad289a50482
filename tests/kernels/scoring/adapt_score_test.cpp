#include "kernels/scoring/adapt_score.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "kernels/scoring/fit_score.hpp"
#include "support/fitted_score.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using test::fitted_score;

struct Rows {
  std::vector<ScoreParts> parts;
  std::vector<std::uint8_t> right;
};

double log_odds_of(const ScoreModel& model, const ScoreParts& parts) {
  const std::array<float, 2> shares = sensor_shares(parts);
  double sum = static_cast<double>(shares[0] * model.bias[0] + shares[1] * model.bias[1]);
  for (std::size_t k = 0; k < kNumScoreParts; ++k)
    sum += static_cast<double>(part_evidence(model, parts, k));
  return sum;
}

/// Score parts of poses of every kind, some beyond all knots.
ScoreParts draw_parts(const ScoreModel& model, test::Random& random) {
  ScoreParts parts;
  for (std::size_t k = 0; k < parts.size(); ++k)
    parts[k] = random.uniform(model.knots[k].front() - 0.5F, model.knots[k].back() + 0.5F);
  parts[kCorrelationPart] = random.uniform(0, 1);
  return parts;
}

/// Poses that are right as often as `model` predicts, like marks from a few scans of a cell with
/// that score.
Rows draw(const ScoreModel& model, std::size_t n, std::uint64_t seed) {
  test::Random random(seed);
  Rows rows;
  while (rows.right.size() < n) {
    // Half of the poses are near the best of each part, because the others are hopeless.
    ScoreParts parts = draw_parts(model, random);
    if (rows.right.size() % 2 == 0) {
      for (std::size_t k = 0; k < kCorrelationPart; ++k) {
        const auto& knots = model.knots[k];
        parts[k] = std::lerp(parts[k], kScoreParts[k].favorable ? knots.back() : knots.front(),
                             random.uniform(0.7F, 1));
      }
    }
    const double p = 1 / (1 + std::exp(-log_odds_of(model, parts)));
    rows.parts.push_back(parts);
    rows.right.push_back(static_cast<double>(random.uniform(0, 1)) < p ? 1 : 0);
  }
  return rows;
}

ScoreAdaptation some_adaptation(test::Random& random) {
  ScoreAdaptation adaptation;
  adaptation.shift = random.uniform(-2, 2);
  for (float& weight : adaptation.weights) weight = random.uniform(0, kMaxCostWeight);
  return adaptation;
}

TEST(AdaptScore, WithoutAdaptationChangesNothing) {
  const ScoreModel& model = fitted_score();
  const ScoreModel same = adapted_score(model, {});
  EXPECT_EQ(same.bias, model.bias);
  EXPECT_EQ(same.weights, model.weights);
  EXPECT_EQ(largest_raise(model, {}), 0);
}

// From the definition: the missing evidence of each part is multiplied by its factor.
TEST(AdaptScore, WeighsWhatEachPartLacks) {
  const ScoreModel& model = fitted_score();
  test::Random random;
  for (int round = 0; round < 100; ++round) {
    const ScoreAdaptation adaptation = some_adaptation(random);
    const ScoreParts parts = draw_parts(model, random);
    const std::array<float, 2> shares = sensor_shares(parts);
    double expected = log_odds_of(model, parts) + static_cast<double>(adaptation.shift);
    for (std::size_t k = 0; k < kNumScoreParts; ++k) {
      const std::array<float, 2> most = most_evidence(model, k);
      const float lack = shares[0] * most[0] + shares[1] * most[1] - part_evidence(model, parts, k);
      expected += static_cast<double>((1 - adaptation.weights[k]) * lack);
    }
    EXPECT_NEAR(log_odds_of(adapted_score(model, adaptation), parts), expected, 2e-3);
  }
}

TEST(AdaptScore, StaysMonotoneInEachPart) {
  test::Random random;
  for (int round = 0; round < 100; ++round) {
    const ScoreModel model = adapted_score(fitted_score(), some_adaptation(random));
    const ScoreParts parts = draw_parts(model, random);
    const float before = pose_probability(model, parts);
    for (std::size_t k = 0; k < kCorrelationPart; ++k) {
      ScoreParts more = parts;
      more[k] += kScoreParts[k].favorable ? 0.3F : -0.3F;
      EXPECT_GE(pose_probability(model, more), before) << kScoreParts[k].name;
    }
  }
}

TEST(AdaptScore, RaisesNoPoseByMoreThanItsLargestRaise) {
  const ScoreModel& model = fitted_score();
  test::Random random;
  for (int round = 0; round < 1000; ++round) {
    const ScoreAdaptation adaptation = some_adaptation(random);
    const ScoreParts parts = draw_parts(model, random);
    const double raise =
        log_odds_of(adapted_score(model, adaptation), parts) - log_odds_of(model, parts);
    EXPECT_LE(raise, static_cast<double>(largest_raise(model, adaptation)) + 2e-3);
  }
}

TEST(FitAdaptation, IsNoneWithoutRows) {
  EXPECT_EQ(fit_adaptation(fitted_score(), {}, {}), ScoreAdaptation{});
}

TEST(FitAdaptation, ChangesLittleByLittleData) {
  const Rows rows = draw(fitted_score(), 4, 1);
  const ScoreAdaptation adaptation = fit_adaptation(fitted_score(), rows.parts, rows.right);
  EXPECT_LT(std::abs(adaptation.shift), 0.6F);
  for (const float weight : adaptation.weights) EXPECT_NEAR(weight, 1, 0.6F);
}

// The marked scans of a cell help from as few as five on, and have full effect when there are many.
TEST(FitAdaptation, ScoresFreshPosesOfItsCellBetter) {
  ScoreAdaptation truth;
  truth.shift = -1.5F;
  for (std::size_t k = 0; k < kCorrelationPart; ++k) truth.weights[k] = k % 3 == 0 ? 0.8F : 1.4F;
  const ScoreModel cell = adapted_score(fitted_score(), truth);
  const Rows fresh = draw(cell, 4000, 2);
  const double before = log_loss(fitted_score(), fresh.parts, fresh.right);
  double last = before;
  for (const std::size_t n : {200U, 1000U, 10000U}) {
    const Rows rows = draw(cell, n, 3);
    const ScoreModel adapted =
        adapted_score(fitted_score(), fit_adaptation(fitted_score(), rows.parts, rows.right));
    last = log_loss(adapted, fresh.parts, fresh.right);
    EXPECT_LT(last, before) << n;
  }
  EXPECT_NEAR(last, log_loss(cell, fresh.parts, fresh.right), 0.01);
}

// Covers arbitrary marks, including everything right and the opposite of the truth.
TEST(FitAdaptation, RaisesNoOddsMoreThanTenfoldByAnyMarks) {
  const ScoreModel& model = fitted_score();
  for (const int marks : {0, 1, 2, 3}) {
    Rows rows = draw(model, 300, 4);
    test::Random random(static_cast<std::uint64_t>(marks));
    for (std::uint8_t& right : rows.right) {
      right = static_cast<std::uint8_t>(marks == 0   ? 1
                                        : marks == 1 ? 0
                                        : marks == 2 ? 1 - right
                                                     : random.below(2));
    }
    const ScoreAdaptation adaptation = fit_adaptation(model, rows.parts, rows.right);
    EXPECT_LE(largest_raise(model, adaptation), kMaxRaise) << marks;
    const ScoreModel adapted = adapted_score(model, adaptation);
    for (int round = 0; round < 2000; ++round) {
      const ScoreParts parts = draw_parts(model, random);
      const float before = pose_probability(model, parts), after = pose_probability(adapted, parts);
      if (before < 0.09F) {
        EXPECT_LT(after, 0.5F) << marks;
      }
      if (before < 0.28F) {
        EXPECT_LT(after, 0.8F) << marks;
      }
    }
  }
}

// Marks that call for more than the bound are applied up to the bound, not dropped.
TEST(FitAdaptation, GoesToTheBoundWhereMarksAskForMore) {
  const ScoreModel& model = fitted_score();
  Rows rows = draw(model, 300, 5);
  std::ranges::fill(rows.right, std::uint8_t{1});
  const float raise = largest_raise(model, fit_adaptation(model, rows.parts, rows.right));
  EXPECT_GT(raise, 0.9F * kMaxRaise);
}

TEST(FitAdaptation, GivesTheSameBitsForAnyOrder) {
  const Rows rows = draw(fitted_score(), 200, 6);
  const ScoreAdaptation first = fit_adaptation(fitted_score(), rows.parts, rows.right);
  std::vector<std::size_t> order(rows.right.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  test::Random random;
  for (int round = 0; round < 3; ++round) {
    for (std::size_t i = order.size(); i > 1; --i)
      std::swap(order[i - 1], order[random.below(static_cast<std::uint32_t>(i))]);
    Rows shuffled;
    for (const std::size_t i : order) {
      shuffled.parts.push_back(rows.parts[i]);
      shuffled.right.push_back(rows.right[i]);
    }
    EXPECT_EQ(fit_adaptation(fitted_score(), shuffled.parts, shuffled.right), first);
  }
}

}  // namespace
}  // namespace trivet::kernels
