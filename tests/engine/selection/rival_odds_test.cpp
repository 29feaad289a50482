#include "engine/selection/rival_odds.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace trivet::engine {
namespace {

double log_odds(float score, float other, double z) {
  Candidate a, b;
  a.score = score;
  b.score = other;
  return rival_log_odds(a, b, {0, 0, z});
}

TEST(RivalLogOdds, AreZeroBetweenEquals) { EXPECT_EQ(log_odds(0.7F, 0.7F, 0), 0); }

TEST(RivalLogOdds, RiseWithThePixelsAndTheScore) {
  EXPECT_GT(log_odds(0.7F, 0.7F, 0.5), 0);
  EXPECT_GT(log_odds(0.9F, 0.7F, 0), 0);
  EXPECT_GT(log_odds(0.7F, 0.9F, 2.5), 0) << "pixels that differ tell more than scores";
  EXPECT_LT(log_odds(0.7F, 0.999F, 1), 0);
}

TEST(RivalLogOdds, AreTheOppositeOfThoseOfTheOther) {
  EXPECT_DOUBLE_EQ(log_odds(0.6F, 0.95F, 1.2), -log_odds(0.95F, 0.6F, -1.2));
}

TEST(RivalLogOdds, AreNumbersAtTheEnds) {
  EXPECT_TRUE(std::isfinite(log_odds(0, 1, 0)));
  EXPECT_TRUE(std::isfinite(log_odds(1, 0, 0)));
}

}  // namespace
}  // namespace trivet::engine
