#include "engine/evaluation/score_curves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.hpp"

namespace trivet {
namespace {

using Outcomes = std::vector<ScoredOutcome>;

Outcomes random_outcomes(test::Random& random, int n) {
  Outcomes outcomes;
  for (int i = 0; i < n; ++i) {
    // A coarse grid of scores, for many ties.
    const double score = std::floor(20 * static_cast<double>(random.uniform(0, 1))) / 20;
    outcomes.push_back({score, static_cast<double>(random.uniform(0, 1)) < score});
  }
  return outcomes;
}

/// Right detections and all detections with at least this score.
std::pair<double, double> reported(const Outcomes& outcomes, double score) {
  double right = 0, all = 0;
  for (const ScoredOutcome& outcome : outcomes) {
    if (outcome.score < score) continue;
    ++all;
    right += outcome.right ? 1 : 0;
  }
  return {right, all};
}

// By hand: the thresholds 0.9, 0.8, 0.6, 0.4 select 1/1, 1/2, 2/3, 3/5 of 4 instances.
TEST(PrecisionRecall, AgreesWithAnExampleByHand) {
  const Outcomes outcomes{{0.4, true}, {0.9, true}, {0.8, false}, {0.6, true}, {0.4, false}};
  const PrecisionRecall curve = precision_recall(outcomes, 4);
  ASSERT_EQ(curve.points.size(), 4U);
  EXPECT_DOUBLE_EQ(curve.points[1].precision, 0.5);
  EXPECT_DOUBLE_EQ(curve.points[1].recall, 0.25);
  EXPECT_DOUBLE_EQ(curve.points[3].precision, 0.6);
  EXPECT_DOUBLE_EQ(curve.points[3].recall, 0.75);
  EXPECT_DOUBLE_EQ(curve.average_precision, 0.25 * 1 + 0.25 * 2 / 3 + 0.25 * 0.6);
  ASSERT_TRUE(curve.best_f1);
  EXPECT_DOUBLE_EQ(curve.best_f1->score, 0.4);
  EXPECT_DOUBLE_EQ(curve.best_f1->f1(), 2 * 0.6 * 0.75 / 1.35);
}

TEST(PrecisionRecall, AgreesWithTheDefinitionsOnRandomScores) {
  test::Random random;
  for (const int n : {1, 2, 3, 17, 200}) {
    const Outcomes outcomes = random_outcomes(random, n);
    const std::size_t instances = static_cast<std::size_t>(n);
    const PrecisionRecall curve = precision_recall(outcomes, instances);
    double previous = 2;
    for (const OperatingPoint& point : curve.points) {
      EXPECT_LT(point.score, previous);
      previous = point.score;
      const auto [right, all] = reported(outcomes, point.score);
      EXPECT_DOUBLE_EQ(point.precision, right / all);
      EXPECT_DOUBLE_EQ(point.recall, right / n);
      EXPECT_LE(point.f1(), curve.best_f1->f1());
    }
    // Every right detection adds 1 / n of recall at the best precision of that or any higher
    // recall.
    double area = 0;
    for (int k = 1; k <= n; ++k) {
      double best = 0;
      for (const OperatingPoint& point : curve.points) {
        if (point.recall * n >= k - 1e-9) best = std::max(best, point.precision);
      }
      area += best / n;
    }
    EXPECT_NEAR(curve.average_precision, area, 1e-12);
  }
}

TEST(PrecisionRecall, DoesNotDependOnTheOrderOfEqualScores) {
  test::Random random;
  Outcomes outcomes = random_outcomes(random, 100);
  const double area = precision_recall(outcomes, 80).average_precision;
  std::reverse(outcomes.begin(), outcomes.end());
  EXPECT_EQ(precision_recall(outcomes, 80).average_precision, area);
}

TEST(PrecisionRecall, HoldsWithoutDetectionsOrInstances) {
  EXPECT_TRUE(precision_recall({}, 5).points.empty());
  EXPECT_FALSE(precision_recall({}, 5).best_f1);
  const PrecisionRecall curve = precision_recall(Outcomes{{0.5, false}}, 0);
  ASSERT_EQ(curve.points.size(), 1U);
  EXPECT_EQ(curve.points[0].recall, 0);
  EXPECT_EQ(curve.average_precision, 0);
}

TEST(Calibrate, AgreesWithTheDefinition) {
  test::Random random;
  const Outcomes outcomes = random_outcomes(random, 500);
  const auto calibration = calibrate(outcomes);
  ASSERT_TRUE(calibration);
  ASSERT_EQ(calibration->bins.size(), 10U);
  double error = 0;
  std::size_t all = 0;
  for (const CalibrationBin& bin : calibration->bins) {
    double score = 0, right = 0, n = 0;
    for (const ScoredOutcome& outcome : outcomes) {
      if (outcome.score < bin.low || outcome.score >= bin.high) continue;
      score += outcome.score;
      right += outcome.right ? 1 : 0;
      ++n;
    }
    EXPECT_EQ(static_cast<double>(bin.all), n);
    EXPECT_EQ(static_cast<double>(bin.right), right);
    EXPECT_NEAR(bin.mean_score, score / n, 1e-12);
    error += std::abs(score - right) / 500;
    all += bin.all;
  }
  EXPECT_EQ(all, 500U);
  EXPECT_NEAR(calibration->expected_error, error, 1e-12);
}

TEST(Calibrate, PutsBothEndsIntoBins) {
  const auto calibration = calibrate(Outcomes{{0, false}, {1, true}});
  ASSERT_TRUE(calibration);
  EXPECT_EQ(calibration->bins.front().all, 1U);
  EXPECT_EQ(calibration->bins.back().right, 1U);
  EXPECT_EQ(calibration->expected_error, 0);
}

TEST(Calibrate, LeavesScoresThatAreNoProbabilitiesAlone) {
  EXPECT_FALSE(calibrate({}));
  EXPECT_FALSE(calibrate(Outcomes{{0.5, true}, {412, true}}));
  EXPECT_FALSE(calibrate(Outcomes{{-0.1, true}}));
}

// The ends of the interval are the roots p of |right / n - p| = z sqrt(p (1 - p) / n).
TEST(WilsonInterval, SolvesItsEquation) {
  for (const auto& [right, n] :
       {std::pair<std::size_t, std::size_t>{7, 10}, {1, 3}, {99, 100}, {0, 5}, {5, 5}}) {
    const auto [low, high] = wilson_interval(right, n);
    const double rate = static_cast<double>(right) / static_cast<double>(n);
    EXPECT_LE(low, rate);
    EXPECT_GE(high, rate);
    for (const double p : {low, high}) {
      EXPECT_NEAR(std::abs(rate - p), 1.959964 * std::sqrt(p * (1 - p) / static_cast<double>(n)),
                  1e-6);
    }
  }
  EXPECT_EQ(wilson_interval(0, 0), (std::pair<double, double>{0, 1}));
}

}  // namespace
}  // namespace trivet
