#include <gtest/gtest.h>

#include <algorithm>

#include "engine/recognition/recognize.hpp"
#include "engine/recognition/two_parts.hpp"
#include "engine/scene/read_scene.hpp"

namespace trivet {
namespace {

class ExplainPlace : public test::TwoParts {
 protected:
  static SceneResult ask(const Eigen::Vector3d& point, RecognizeOptions options = {},
                         const Cloud& scene = clutter(), const SceneInput& input = {}) {
    options.explain.point = point;
    auto result = recognize(recognizer_, scene, input, options);
    EXPECT_TRUE(result) << result.error().message;
    EXPECT_TRUE(result->explanation);
    return *std::move(result);
  }
  static const ModelExplanation* of(const SceneResult& result, const std::string& model) {
    for (const ModelExplanation& one : result.explanation->models)
      if (one.model == model) return &one;
    return nullptr;
  }
  /// The top of a bracket's pillar, and a point on a lever's arm.
  static Eigen::Vector3d on_bracket(const Pose& pose) {
    return (pose * Eigen::Vector3f(-0.05F, -0.015F, 0.11F)).cast<double>();
  }
  static Eigen::Vector3d on_lever(const Pose& pose) {
    return (pose * Eigen::Vector3f(0.05F, -0.045F, 0)).cast<double>();
  }
};

TEST_F(ExplainPlace, NamesTheDetectionThatLiesThereAndWhatOthersCameTo) {
  const SceneResult result = ask(on_bracket(bracket_pose()));
  EXPECT_EQ(result.explanation->point, on_bracket(bracket_pose()));
  EXPECT_LT(result.explanation->nearest_point, 0.05);
  ASSERT_FALSE(result.explanation->models.empty());
  const ModelExplanation& first = result.explanation->models.front();
  EXPECT_EQ(first.model, "bracket");
  ASSERT_TRUE(first.detection);
  EXPECT_EQ(result.detections[*first.detection].model, "bracket");
  EXPECT_EQ(first.reached(), PoseStage::examined);
  EXPECT_FALSE(first.pose);
  const auto agreeing =
      std::ranges::count(first.rays, kernels::RayVerdict::agrees, &kernels::JudgedRay::verdict);
  EXPECT_GT(2 * agreeing, std::ssize(first.rays));
  const ModelExplanation* const other = of(result, "lever");
  ASSERT_NE(other, nullptr);
  EXPECT_FALSE(other->detection);
  EXPECT_TRUE(other->reached());
  EXPECT_TRUE(!other->pose || other->pose->score < 0.8F);
}

TEST_F(ExplainPlace, ChangesNoResultAndNeedsNoUnitOfTheLibrary) {
  const SceneResult asked = ask(on_lever(lever_pose()));
  const auto plain = recognize(recognizer_, clutter(), {}, {});
  ASSERT_TRUE(plain);
  ASSERT_EQ(asked.detections.size(), plain->detections.size());
  for (std::size_t d = 0; d < plain->detections.size(); ++d) {
    EXPECT_EQ(asked.detections[d].score, plain->detections[d].score);
    EXPECT_EQ(asked.detections[d].T_scene_model.matrix(),
              plain->detections[d].T_scene_model.matrix());
  }
  const SceneResult in_mm =
      ask(1000 * on_lever(lever_pose()), {}, in_millimeters(clutter()), {.scale = 1e-3});
  ASSERT_EQ(in_mm.explanation->models.size(), asked.explanation->models.size());
  EXPECT_NEAR(in_mm.explanation->nearest_point, 1000 * asked.explanation->nearest_point, 0.1);
  EXPECT_EQ(in_mm.explanation->models[0].detection, asked.explanation->models[0].detection);
  const std::vector<kernels::JudgedRay>& rays = asked.explanation->models[0].rays;
  ASSERT_EQ(in_mm.explanation->models[0].rays.size(), rays.size());
  for (std::size_t k = 0; k < rays.size(); ++k)
    EXPECT_LT((in_mm.explanation->models[0].rays[k].place - 1000 * rays[k].place).norm(), 0.2F);
}

TEST_F(ExplainPlace, TestsAfterAllWhatWasGivenUp) {
  const Pose second = test::pose_of({0.3F, -0.4F, 1.2F}, {-0.25F, -0.02F, 0.9F});
  const Cloud scene = test::render_scan({{&bracket_, bracket_pose()}, {&bracket_, second}});
  RecognizeOptions options;
  options.pose.rounds = 1;
  options.pose.max_examined = 1;
  for (const Pose& place : {bracket_pose(), second}) {
    const SceneResult result = ask(on_bracket(place), options, scene);
    ASSERT_EQ(result.detections.size(), 1U);
    const ModelExplanation* const bracket = of(result, "bracket");
    ASSERT_NE(bracket, nullptr);
    if (bracket->detection) continue;
    EXPECT_TRUE(bracket->given_up);
    ASSERT_TRUE(bracket->pose);
    EXPECT_GT(bracket->pose->score, 0.8F);
    const auto error =
        kernels::pose_distance(place, bracket->pose->T_scene_model, {}, Eigen::Vector3f::Zero());
    EXPECT_LT(error.translation, 0.01F);
  }
}

TEST_F(ExplainPlace, SaysWhereNothingIs) {
  const SceneResult result = ask({0.3, 0.3, -2});
  EXPECT_TRUE(result.explanation->models.empty());
  EXPECT_GT(result.explanation->nearest_point, 2);
  RecognizeOptions options;
  options.explain.models = {"lever"};
  const SceneResult named = ask({0.3, 0.3, -2}, options);
  ASSERT_EQ(named.explanation->models.size(), 1U);
  EXPECT_FALSE(named.explanation->models[0].reached());
  EXPECT_FALSE(named.explanation->models[0].pose);
  options.explain = {Eigen::Vector3d(0, 0, 1), {"nut"}};
  EXPECT_EQ(recognize(recognizer_, clutter(), {}, options).error().code, ErrorCode::usage);
}

TEST_F(ExplainPlace, IsOfTheFrameOfTheFile) {
  Cloud far = clutter();
  far.offset = Eigen::Vector3d(4e5, 5e6, 100);
  const SceneResult result = ask(far.offset + on_bracket(bracket_pose()), {}, far);
  ASSERT_FALSE(result.explanation->models.empty());
  EXPECT_TRUE(result.explanation->models[0].detection);
}

}  // namespace
}  // namespace trivet
