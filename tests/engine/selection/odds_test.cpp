#include "engine/selection/odds.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace trivet::engine {
namespace {

double of_rivals(float score, float other, double z) {
  return rival_log_odds(score, other, {.z = z});
}

TEST(ScaleOdds, ScalesThem) {
  EXPECT_FLOAT_EQ(scale_odds(0.75F, 1), 0.75F);
  EXPECT_FLOAT_EQ(scale_odds(0.75F, 1.0F / 3), 0.5F) << "from 3 to 1";
  EXPECT_EQ(scale_odds(1, 0.5F), 1);
  EXPECT_EQ(scale_odds(0, 0.5F), 0);
}

TEST(ScoreBesideStrange, FallsWithTheShareOfStrangeAnswers) {
  EXPECT_EQ(score_beside_strange(0.9F, 0), 0.9F);
  EXPECT_GT(score_beside_strange(0.9F, 0.01F), 0.89F) << "what is unlikely raises no doubt";
  EXPECT_FLOAT_EQ(score_beside_strange(0.9F, 1), scale_odds(0.9F, 0.1F));
  float before = 0.9F;
  for (const float share : {0.2F, 0.4F, 0.6F, 0.8F, 1.0F}) {
    const float score = score_beside_strange(0.9F, share);
    EXPECT_LT(score, before);
    before = score;
  }
}

TEST(RivalLogOdds, AreZeroBetweenEquals) { EXPECT_EQ(of_rivals(0.7F, 0.7F, 0), 0); }

TEST(RivalLogOdds, RiseWithThePixelsAndTheScore) {
  EXPECT_GT(of_rivals(0.7F, 0.7F, 0.5), 0);
  EXPECT_GT(of_rivals(0.9F, 0.7F, 0), 0);
  EXPECT_GT(of_rivals(0.7F, 0.9F, 2.5), 0) << "differing pixels are more informative than scores";
  EXPECT_LT(of_rivals(0.7F, 0.999F, 1), 0);
}

TEST(RivalLogOdds, AreTheOppositeOfThoseOfTheOther) {
  EXPECT_DOUBLE_EQ(of_rivals(0.6F, 0.95F, 1.2), -of_rivals(0.95F, 0.6F, -1.2));
}

TEST(RivalLogOdds, AreNumbersAtTheEnds) {
  EXPECT_TRUE(std::isfinite(of_rivals(0, 1, 0)));
  EXPECT_TRUE(std::isfinite(of_rivals(1, 0, 0)));
}

}  // namespace
}  // namespace trivet::engine
