#include <gtest/gtest.h>

#include <cmath>

#include "engine/recognition/recognize.hpp"
#include "engine/recognition/two_parts.hpp"
#include "engine/selection/odds.hpp"
#include "engine/training/train.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

/// Alternative poses that fit equally well, and the confidence in a pose.
class RecognizeAlternatives : public test::TwoParts {};

// The score belongs to the refined pose, not to its initial pose.
TEST_F(RecognizeAlternatives, SettlesToOneResultFromADozenStarts) {
  test::Random random;
  Cloud scan = clutter();
  for (float& coordinate : scan.points.span().z) coordinate += random.normal(0.0005F);
  std::vector<Detection> settled;
  for (int start = 0; start < 12; ++start) {
    const Pose off = test::pose_of(0.05F * random.direction(), 0.004F * random.direction());
    RecognizeOptions options{.min_score = 0};
    options.expected = {{"bracket", (bracket_pose() * off).cast<double>()}};
    options.pose.rounds = 0;
    const auto result = recognize(recognizer_, scan, {}, options);
    ASSERT_TRUE(result) << result.error().message;
    ASSERT_EQ(result->detections.size(), 1U) << start;
    settled.push_back(result->detections[0]);
  }
  for (const Detection& detection : settled) {
    expect_pose(&detection, settled[0].T_scene_model, 0.2F);
    EXPECT_NEAR(detection.score, settled[0].score, 0.02F);
  }
}

// A block with a knob at one end, which is hidden: it may as well lie the other way round.
TEST_F(RecognizeAlternatives, NamesThePosesThatFitAlike) {
  test::Shape key = test::box({-0.1F, -0.03F, -0.02F}, {0.1F, 0.03F, 0.02F});
  key.join(test::box({0.07F, -0.02F, 0.02F}, {0.09F, 0.02F, 0.04F}));
  auto trained = train_model(test::cloud_of(key), {"key", "key.ply", 1, {}}, {});
  ASSERT_TRUE(trained) << trained.error().message;
  ASSERT_FALSE(trained->model.near_symmetries.empty());
  const Recognizer recognizer(Library({std::move(trained->model)}));
  const Pose pose = test::pose_of({2.6F, 0.2F, 0.1F}, {0, 0, 0.8F});
  const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
  const auto open =
      recognize(recognizer, test::render_scan({{&wall, Pose::Identity()}, {&key, pose}}), {}, {});
  ASSERT_TRUE(open);
  ASSERT_EQ(open->detections.size(), 1U);
  EXPECT_TRUE(open->detections[0].alternatives.empty()) << "the knob is seen";
  EXPECT_GT(open->detections[0].pose_share, 0.95F);

  const Eigen::Vector3f knob = pose * Eigen::Vector3f(0.08F, 0, 0.03F);
  const test::Shape cover = test::box({-0.05F, -0.1F, -0.005F}, {0.05F, 0.1F, 0.005F});
  const Pose before = test::pose_of({0, 0, 0}, 0.8F * knob);
  const auto hidden = recognize(
      recognizer, test::render_scan({{&wall, Pose::Identity()}, {&key, pose}, {&cover, before}}),
      {}, {.min_score = 0.05F, .max_rejected = 2});
  ASSERT_TRUE(hidden);
  ASSERT_GE(hidden->detections.size(), 1U);
  const Detection& found = hidden->detections[0];
  EXPECT_FALSE(found.alternatives.empty());
  EXPECT_NEAR(found.score, kernels::pose_probability(recognizer.score(), found.parts), 1e-3F)
      << "that the key is there is as sure as it looks";
}

// A plank with hidden ends may be shifted along itself, although it has no such symmetry.
TEST_F(RecognizeAlternatives, IsLessSureOfWhatMayLieOtherwiseInItsPlace) {
  const test::Shape plank = test::box({-0.15F, -0.03F, -0.02F}, {0.15F, 0.03F, 0.02F});
  const Recognizer recognizer(test::trained_library({{"plank", &plank}}));
  const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
  const test::Shape left = test::box({-0.25F, -0.08F, 0.7F}, {-0.085F, 0.08F, 0.71F});
  const test::Shape right = test::box({0.085F, -0.08F, 0.7F}, {0.25F, 0.08F, 0.71F});
  const Pose pose = test::pose_of({0.6F, 0, 0}, {0, 0, 0.8F});
  const Cloud scene = test::render_scan({{&wall, Pose::Identity()},
                                         {&plank, pose},
                                         {&left, Pose::Identity()},
                                         {&right, Pose::Identity()}});
  const auto found_of = [&](std::vector<ExpectedPose> expected) {
    RecognizeOptions options{.min_score = 0};
    options.pose.rounds = 0;
    options.expected = std::move(expected);
    const auto result = recognize(recognizer, scene, {}, options);
    EXPECT_TRUE(result && result->detections.size() == 1);
    return result->detections.at(0);
  };
  const Pose farther = test::pose_of({0, 0, 0}, {0.04F, 0, 0}) * pose;
  const Detection alone = found_of({{"plank", pose.cast<double>()}});
  EXPECT_TRUE(alone.alternatives.empty());
  EXPECT_EQ(alone.score, kernels::pose_probability(recognizer.score(), alone.parts));
  const Detection ambiguous =
      found_of({{"plank", pose.cast<double>()}, {"plank", farther.cast<double>()}});
  EXPECT_EQ(ambiguous.alternatives.size(), 1U);
  EXPECT_LT(ambiguous.pose_share, 0.9F);
  EXPECT_GE(ambiguous.pose_share, 0.5F) << "the likelier one is reported";
  const float fitted = kernels::pose_probability(recognizer.score(), ambiguous.parts);
  EXPECT_LT(ambiguous.score, fitted);
  EXPECT_NEAR(ambiguous.score, engine::score_beside_strange(fitted, 1 - ambiguous.pose_share),
              1e-6F);
}

// A mug is rotationally symmetric except for its handle.
TEST_F(RecognizeAlternatives, TurnsAMugToItsHandleAndDoubtsTheTurnWhereThatIsHidden) {
  test::Shape mug = test::prism(60, test::circle(0.04), -0.05, 0.05, 0.035, 0.9);
  mug.join(test::box({0.036F, -0.006F, -0.025F}, {0.065F, 0.006F, 0.025F}));
  auto trained = train_model(test::cloud_of(mug), {"mug", "mug.ply", 1, {}}, {});
  ASSERT_TRUE(trained) << trained.error().message;
  ASSERT_TRUE(trained->model.near_axis);
  const Recognizer recognizer(Library({std::move(trained->model)}));
  const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
  const auto pose_of = [](float turn) {
    return test::pose_of({1.9F, 0, 0}, {0, 0, 0.6F}) * test::pose_of({0, 0, turn}, {0, 0, 0});
  };
  const auto scan_of = [&](float turn) {
    return test::render_scan({{&wall, Pose::Identity()}, {&mug, pose_of(turn)}});
  };
  const auto recognize_turned = [&](float turn, ImprovementSet ablated = {}) {
    const auto result =
        recognize(recognizer, scan_of(turn), {}, {.min_score = 0, .ablated = ablated});
    EXPECT_TRUE(result && !result->detections.empty());
    return std::pair{pose_of(turn), result->detections.at(0)};
  };
  for (const float turn : {-1.2F, -0.3F, 0.4F, 2.9F}) {
    const auto [pose, found] = recognize_turned(turn);
    EXPECT_LT(kernels::rotation_angle(pose.linear(), found.T_scene_model.linear()), 0.04F) << turn;
    EXPECT_GT(found.score, 0.8F) << turn;
    EXPECT_TRUE(found.alternatives.empty()) << turn;
    EXPECT_GT(found.pose_share, 0.95F) << turn;
    EXPECT_FALSE(found.turns) << turn;
  }
  constexpr float kBehind = 1.57F;
  const Detection hidden = recognize_turned(kBehind).second;
  EXPECT_GT(hidden.score, 0.8F) << "it is a mug";
  EXPECT_EQ(hidden.score, kernels::pose_probability(recognizer.score(), hidden.parts));
  EXPECT_LT(hidden.pose_share, 0.5F) << "its turn is open";
  EXPECT_FALSE(hidden.alternatives.empty());
  ASSERT_TRUE(hidden.turns);
  EXPECT_GT(std::abs(hidden.turns->axis.direction.z()), 0.99F);
  EXPECT_LE(hidden.turns->low, 0) << "from the pose on";
  EXPECT_GE(hidden.turns->high, 0);
  EXPECT_GT(hidden.turns->high - hidden.turns->low, 0.5F);
  const auto scaled =
      recognize(recognizer, in_millimeters(scan_of(kBehind)), {.scale = 1e-3}, {.min_score = 0});
  ASSERT_TRUE(scaled && !scaled->detections.empty() && scaled->detections[0].turns);
  EXPECT_LT((scaled->detections[0].turns->axis.point - 1000 * hidden.turns->axis.point).norm(),
            0.01F * hidden.turns->axis.point.norm() * 1000)
      << "in the scene's unit, as the pose is";
  const Detection unambiguous = recognize_turned(kBehind, {Improvement::alternatives}).second;
  EXPECT_EQ(unambiguous.score, kernels::pose_probability(recognizer.score(), unambiguous.parts));
  EXPECT_TRUE(unambiguous.alternatives.empty());
  EXPECT_EQ(unambiguous.pose_share, 1);
  EXPECT_FALSE(unambiguous.turns);

  // Requests that require a unique pose get none; the mug alone is present.
  const auto with = [&](float turn, bool require_pose) {
    const auto result =
        recognize(recognizer, scan_of(turn), {},
                  {.min_score = 0.7F, .max_rejected = 1, .require_pose = require_pose});
    EXPECT_TRUE(result);
    return *result;
  };
  EXPECT_EQ(with(0.4F, true).detections.size(), 1U) << "its handle is seen";
  EXPECT_EQ(with(kBehind, false).detections.size(), 1U);
  const SceneResult refused = with(kBehind, true);
  EXPECT_TRUE(refused.detections.empty());
  ASSERT_FALSE(refused.rejected.empty());
  EXPECT_EQ(refused.rejected[0].reason, Rejection::too_low);
  EXPECT_NEAR(refused.rejected[0].score, hidden.score, 1e-3F) << "of the object";
}

}  // namespace
}  // namespace trivet
