#include "engine/evaluation/average_precision.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random.hpp"

namespace trivet::engine {
namespace {

/// Matches in descending order of score.
std::vector<ScoredMatch> ranked(const std::vector<bool>& found) {
  std::vector<ScoredMatch> matches;
  for (std::size_t i = 0; i < found.size(); ++i)
    matches.push_back({1.0F - 0.001F * static_cast<float>(i), found[i]});
  return matches;
}

double of(const std::vector<bool>& found, std::size_t num_targets) {
  std::vector<ScoredMatch> matches = ranked(found);
  return average_precision(matches, num_targets);
}

TEST(AveragePrecision, IsOneForAllFoundBeforeAnyFalse) {
  EXPECT_EQ(of({true}, 1), 1);
  EXPECT_EQ(of({true, true, true, false, false}, 3), 1);
}

TEST(AveragePrecision, IsZeroWithoutMatchesOrTargets) {
  EXPECT_EQ(of({}, 3), 0);
  EXPECT_EQ(of({false, false}, 3), 0);
  EXPECT_EQ(of({}, 0), 0);
  EXPECT_EQ(of({false}, 0), 0);
}

// Recall 1/4 is reached at precision 1, recall 2/4 at 2/3: places 0 to 25 and 26 to 50 of 101.
TEST(AveragePrecision, WeighsEachPrecisionByThePlacesItReaches) {
  EXPECT_NEAR(of({true, false, true, false, false}, 4), (26 * 1 + 25 * 2.0 / 3) / 101, 1e-15);
}

// Of the precisions 1/1, 2/3 and 3/4, recall 2/3 uses the better 3/4.
TEST(AveragePrecision, UsesTheBestPrecisionAtThatRecallOrMore) {
  EXPECT_NEAR(of({true, false, true, true}, 3), (34 * 1 + 67 * 0.75) / 101, 1e-15);
}

// 35 * 0.01 is an ulp above 35 / 100.
TEST(AveragePrecision, ComparesRecallsInDoubleArithmetic) {
  EXPECT_NEAR(of(std::vector<bool>(35, true), 100), 35.0 / 101, 1e-15);
  EXPECT_NEAR(of(std::vector<bool>(36, true), 100), 37.0 / 101, 1e-15);
}

TEST(AveragePrecision, SortsByFallingScoreAndKeepsTheOrderOfEquals) {
  std::vector<ScoredMatch> rising{{0.2F, true}, {0.5F, false}, {0.9F, true}};
  EXPECT_NEAR(average_precision(rising, 2), of({true, false, true}, 2), 1e-15);
  std::vector<ScoredMatch> equal{{0.5F, false}, {0.5F, true}};
  EXPECT_NEAR(average_precision(equal, 1), 0.5, 1e-15);
  std::reverse(equal.begin(), equal.end());
  EXPECT_NEAR(average_precision(equal, 1), 1, 1e-15);
}

TEST(AveragePrecision, AgreesWithItsDefinitionOnRandomMatches) {
  test::Random random;
  for (int round = 0; round < 200; ++round) {
    std::vector<bool> found(random.below(60));
    for (std::size_t i = 0; i < found.size(); ++i) found[i] = random.below(3) > 0;
    const auto num_found = static_cast<std::size_t>(std::count(found.begin(), found.end(), true));
    const std::size_t num_targets = num_found + 1 + random.below(5);
    double sum = 0;
    for (int place = 0; place <= 100; ++place) {
      double best = 0, right = 0;
      for (std::size_t i = 0; i < found.size(); ++i) {
        right += found[i] ? 1 : 0;
        if (right / static_cast<double>(num_targets) >= place * 0.01)
          best = std::max(best, right / static_cast<double>(i + 1));
      }
      sum += best;
    }
    EXPECT_NEAR(of(found, num_targets), sum / 101, 1e-12);
  }
}

}  // namespace
}  // namespace trivet::engine
