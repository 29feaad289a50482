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
class Candidates : public testing::Test {
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
    static const test::Shape cover = test::box({0.03F, -0.04F, 0.5F}, {0.17F, 0.04F, 0.51F});
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

TEST_F(Candidates, AreOneAnswerWhereTheScanDoesNotDistinguishThem) {
  const std::vector<Detection> detections = found(both_, false);
  ASSERT_FALSE(detections.empty());
  EXPECT_EQ(detections[0].model, "short");
  EXPECT_GT(detections[0].score, 0.9F);
  EXPECT_EQ(detections[0].candidates.size(), 1U)
      << "its pin ends where that of the long one goes on";
  EXPECT_EQ(detections[0].identity(), 1);

  const std::vector<Detection> hidden = found(both_, true, 0.8F), alone = found(one_, true);
  ASSERT_EQ(hidden.size(), 1U) << "one answer, and reported: one of them is here";
  ASSERT_FALSE(alone.empty());
  ASSERT_EQ(hidden[0].candidates.size(), 2U);
  EXPECT_EQ(hidden[0].candidates[0].model, hidden[0].model);
  EXPECT_NE(hidden[0].candidates[1].model, hidden[0].model);
  EXPECT_NEAR(hidden[0].identity(), 0.5F, 0.1F) << "either may lie there";
  EXPECT_NEAR(hidden[0].candidates[0].share + hidden[0].candidates[1].share, 1, 1e-5F);
  EXPECT_GE(hidden[0].score, alone[0].score - 0.02F) << "it is there as surely as a single model";
  EXPECT_EQ(alone[0].candidates.size(), 1U);
}

TEST_F(Candidates, ReportWhatTellsThemApart) {
  const std::vector<Detection> hidden = found(both_, true, 0.8F);
  ASSERT_EQ(hidden.size(), 1U);
  EXPECT_FALSE(hidden[0].candidates.at(0).differs);
  const Candidate& other = hidden[0].candidates.at(1);
  ASSERT_TRUE(other.differs);
  EXPECT_EQ(other.rays, 0U) << "the cover hides the pin";
  EXPECT_NEAR(other.log_odds, 0, 0.4);
  EXPECT_NEAR(other.differs->deviation, 0.045F, 0.01F) << "what one pin is longer by";
  const Eigen::Vector3f end = pose() * Eigen::Vector3f(0.12F, 0, 0);
  EXPECT_LT((other.differs->center - end).norm(), 0.025F) << other.differs->center.transpose();
  EXPECT_NEAR(other.differs->look_from.norm(), 1, 1e-4F);
}

TEST_F(Candidates, MustHaveTheScoreAloneIfTheIdentityIsRequired) {
  const auto with = [&](bool require_identity) {
    const auto result =
        recognize(both_, scan(true), {}, {.min_score = 0.8F, .require_identity = require_identity});
    EXPECT_TRUE(result);
    return result->detections.size();
  };
  EXPECT_EQ(with(false), 1U);
  EXPECT_EQ(with(true), 0U);
}

TEST_F(Candidates, HaveTheScoreOfTheFamily) {
  StageTimes times;
  const auto scene = prepare_scene(scan(true), {}, times);
  ASSERT_TRUE(scene) << scene.error().message;
  PoseTable table;
  for (const auto& [model, score] : {std::pair(0U, 0.95F), std::pair(1U, 0.6F)}) {
    TestedPose tested{pose(), score, {}};
    tested.test.explained.pixels = {1000, 1001, 1002, 1003};
    table.set_tested(table.add(model, Source::ppf, pose()), std::move(tested));
  }
  const std::array<Row, 2> rows{0, 1};
  const TestedPoses poses{both_.library(), *scene, table, rows};
  const PoseTestOptions test;
  RivalComparisons comparisons(both_, *scene, test);
  const auto others = OtherAnswers::among(comparisons, poses, {});
  ASSERT_TRUE(others);
  SettledPose settled{{pose(), 0.6F, {}}, {}};
  ASSERT_TRUE(others->weigh(1, settled));
  EXPECT_NEAR(settled.pose.score, 0.95F, 1e-3F)
      << "what the scan does not tell from it is as likely";
  EXPECT_NEAR(settled.ambiguity.identity(), 0.5F, 0.1F);
}

TEST_F(Candidates, ScoreDoesNotDependOnWhatIsAskedFor) {
  const std::vector<Detection> few = found(both_, false, 0.8F), more = found(both_, false);
  ASSERT_FALSE(few.empty());
  ASSERT_GE(more.size(), few.size());
  for (std::size_t k = 0; k < few.size(); ++k) EXPECT_EQ(few[k].score, more[k].score);
}

}  // namespace
}  // namespace trivet::engine
