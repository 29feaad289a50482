#include "engine/selection/other_answers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet::engine {
namespace {

TEST(OddsInCrowd, FallWithOtherAnswersThatAreNearlyAsLikely) {
  EXPECT_EQ(odds_in_crowd(0.9F, {}), 1) << "alone";
  const auto beside = [](std::vector<float> others) { return odds_in_crowd(0.9F, others); };
  EXPECT_LT(beside({0.6F}), 0.7F);
  EXPECT_LT(beside({0.6F, 0.6F}), beside({0.6F}));
  EXPECT_GT(beside({0.05F}), 0.97F) << "far less likely";
  EXPECT_GT(beside({0.999F}), 0.97F) << "another instance";
  EXPECT_GT(beside({0.6F, 0.99F, 0.99F}), 1.1F * beside({0.6F})) << "there are such objects";
  EXPECT_EQ(beside({0.3F, 0.6F, 0.99F}), beside({0.3F, 0.6F, 0.99F}));
  EXPECT_NEAR(beside({0.3F, 0.6F, 0.99F}), beside({0.99F, 0.6F, 0.3F}), 1e-6F);
}

TEST(OddsInCrowd, AreThoseOfTheFormula) {
  const std::array<float, 4> others{0.97F, 0.4F, 0.15F, 0.02F};
  const double score = 0.85;
  double doubts = 0, sure = 0;
  for (const double p : {0.97, 0.4, 0.15, 0.02}) {
    doubts += std::min(1.0, p / (1 - p) * (1 - score) / score) * p * (1 - p);
    sure += p * p;
  }
  EXPECT_NEAR(odds_in_crowd(static_cast<float>(score), others),
              1 / (1 + doubts / (1 + sure) / 0.05), 1e-5);
}

TEST(OddsInCrowd, AreNumbersAtTheEnds) {
  for (const float score : {0.0F, 1.0F}) {
    for (const float other : {0.0F, 1.0F}) {
      const float odds = odds_in_crowd(score, {&other, 1});
      EXPECT_GE(odds, 0);
      EXPECT_LE(odds, 1);
    }
  }
}

/// Two rods, one with a longer pin at its end.
class Siblings : public testing::Test {
 protected:
  static test::Shape rod(float pin) {
    return test::box({-0.1F, -0.03F, -0.02F}, {0.06F, 0.03F, 0.02F})
        .join(test::box({-0.1F, 0.03F, -0.02F}, {-0.06F, 0.06F, 0.02F}))
        .join(test::box({0.06F, -0.01F, -0.01F}, {pin, 0.01F, 0.01F}));
  }
  static void SetUpTestSuite() {
    short_ = rod(0.085F);
    long_ = rod(0.13F);
    both_ = Recognizer(test::trained_library({{"long", &long_}, {"short", &short_}}));
    one_ = Recognizer(test::trained_library({{"short", &short_}}));
  }
  /// Tilted, so that the end away from the pin is visible and fixes both rods along their axes.
  static Pose pose() { return test::pose_of({0.6F, -0.4F, 0}, {0, 0, 0.7F}); }
  /// The short rod in front of a wall, with its pin hidden or not.
  static Cloud scan(bool hidden) {
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    static const test::Shape cover = test::box({0.03F, -0.1F, 0.5F}, {0.2F, 0.1F, 0.51F});
    std::vector<test::Placed> things{{&wall, Pose::Identity()}, {&short_, pose()}};
    if (hidden) things.push_back({&cover, Pose::Identity()});
    return test::render_scan(things);
  }
  static std::vector<Detection> found(const Recognizer& recognizer, bool hidden,
                                      float min_score = 0.02F) {
    const auto result = recognize(recognizer, scan(hidden), {}, {.min_score = min_score});
    EXPECT_TRUE(result);
    return result->detections;
  }
  static inline test::Shape short_, long_;
  static inline Recognizer both_{Library{}}, one_{Library{}};
};

TEST_F(Siblings, ShareTheProbabilityWhereTheScanDoesNotDistinguishThem) {
  const std::vector<Detection> detections = found(both_, false);
  ASSERT_FALSE(detections.empty());
  EXPECT_EQ(detections[0].model, "short");
  EXPECT_GT(detections[0].score, 0.9F);
  EXPECT_TRUE(detections[0].siblings.empty()) << "its pin ends where that of the long one goes on";

  const std::vector<Detection> hidden = found(both_, true), alone = found(one_, true);
  ASSERT_FALSE(hidden.empty());
  ASSERT_FALSE(alone.empty());
  EXPECT_EQ(hidden[0].siblings.size(), 1U);
  EXPECT_NE(hidden[0].siblings.at(0), hidden[0].model);
  EXPECT_TRUE(alone[0].siblings.empty());
  EXPECT_LT(hidden[0].score, 0.65F) << "either may lie there";
  EXPECT_GT(alone[0].score, 0.8F);
  EXPECT_TRUE(found(both_, true, 0.8F).empty()) << "the other one has its turn, and no more";
}

TEST_F(Siblings, ShareByTheirScoresTooWhereManyModelsWereSoughtFor) {
  StageTimes times;
  const auto scene = prepare_scene(scan(true), {}, times);
  ASSERT_TRUE(scene) << scene.error().message;
  PoseTable table;
  for (const auto& [model, score] : {std::pair(0U, 0.6F), std::pair(1U, 0.95F)}) {
    TestedPose tested{pose(), score, {}};
    tested.test.explained.pixels = {1000, 1001, 1002, 1003};
    table.set_tested(table.add(model, Source::ppf, pose()), std::move(tested));
  }
  const std::array<Row, 2> rows{0, 1};
  const TestedPoses poses{both_.library(), *scene, table, rows};
  const auto weighed = [&](Among among) {
    const auto others = OtherAnswers::among(both_, poses, {}, {}, among);
    EXPECT_TRUE(others);
    SettledPose settled{{pose(), 0.95F, {}}, {}};
    EXPECT_TRUE(others->weigh(1, settled));
    return settled.pose.score;
  };
  EXPECT_LT(weighed(Among::few_models), 0.6F) << "the scan does not distinguish them";
  EXPECT_GT(weighed(Among::many_models), 0.75F) << "0.95 is far more than 0.6";
}

TEST_F(Siblings, ScoreDoesNotDependOnWhatIsAskedFor) {
  const std::vector<Detection> few = found(both_, false, 0.8F), more = found(both_, false);
  ASSERT_FALSE(few.empty());
  ASSERT_GE(more.size(), few.size());
  for (std::size_t k = 0; k < few.size(); ++k) EXPECT_EQ(few[k].score, more[k].score);
}

}  // namespace
}  // namespace trivet::engine
