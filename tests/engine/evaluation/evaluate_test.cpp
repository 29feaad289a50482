#include "engine/evaluation/evaluate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "support/shapes.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;

Pose pose_at(const Vector3f& translation, float angle_deg = 0,
             const Vector3f& axis = Vector3f::UnitZ()) {
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::AngleAxisf(angle_deg * std::numbers::pi_v<float> / 180, axis).toRotationMatrix();
  pose.translation() = translation;
  return pose;
}

/// One scene; a box of 2 x 3 x 6 (diameter 7) far from its origin, and its twin `other`.
class Evaluate : public testing::Test {
 protected:
  Evaluate() {
    const test::Shape shape = test::box({9, 8.5F, 7}, {11, 11.5F, 13});
    for (const char* name : {"box", "other"}) {
      meshes.push_back({name, shape.vertices, {}, 7, {}});
      manifest.models.push_back({name, "", 1, {}});
    }
    manifest.scenes.resize(1);
  }

  void add_truth(const Pose& pose, const char* model = "box", std::optional<double> occlusion = {},
                 bool ignore = false) {
    manifest.scenes[0].truth.push_back({model, pose, occlusion, ignore});
  }
  void declare(const Symmetry& symmetry) { meshes[0].symmetry = symmetry; }
  void add_detection(const Pose& pose, float score = 0.9F, const char* model = "box") {
    Detection detection;
    detection.model = model;
    detection.score = score;
    detection.T_scene_model = pose;
    result.detections.push_back(detection);
  }
  Evaluation judge(float min_score = 0, bool require_pose = false) {
    const std::vector<std::optional<SceneResult>> results{result};
    Result<Evaluation> evaluation = evaluate(manifest, meshes, results, min_score, require_pose);
    EXPECT_TRUE(evaluation) << evaluation.error().message;
    return *evaluation;
  }
  void expect(std::size_t right, std::size_t instances, std::size_t false_positives) {
    const Evaluation evaluation = judge();
    EXPECT_EQ(evaluation.total.right, right);
    EXPECT_EQ(evaluation.total.instances, instances);
    EXPECT_EQ(evaluation.total.false_positives, false_positives);
  }
  /// The pose after a rotation by this angle in degrees about the center of the box, then a shift.
  static Pose off_by(float angle_deg, const Vector3f& axis,
                     const Vector3f& shift = Vector3f::Zero()) {
    const Vector3f middle(10, 10, 10);
    return pose_at(shift + middle, angle_deg, axis) * pose_at(-middle);
  }

  Manifest manifest;
  std::vector<EvaluationMesh> meshes;
  SceneResult result;
};

TEST_F(Evaluate, CountsTheTruthItselfAsRight) {
  add_truth(pose_at({1, 2, 3}, 50));
  add_detection(pose_at({1, 2, 3}, 50));
  expect(1, 1, 0);
  const Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.add_right, 1U);
  EXPECT_NEAR(*evaluation.median_translation_error, 0, 1e-6);
  EXPECT_NEAR(*evaluation.median_rotation_error_deg, 0, 1e-3);
}

TEST_F(Evaluate, AllowsATenthOfTheDiameterAtTheMiddleOfTheBox) {
  add_truth(Pose::Identity());
  add_detection(pose_at({0.69F, 0, 0}));
  expect(1, 1, 0);
  result.detections[0].T_scene_model = pose_at({0.71F, 0, 0});
  expect(0, 1, 1);
}

TEST_F(Evaluate, AllowsTwelveDegreesAboutTheMiddleWhereverTheOriginLies) {
  add_truth(Pose::Identity());
  add_detection(off_by(11.9F, Vector3f::UnitY()));
  expect(1, 1, 0);
  result.detections[0].T_scene_model = off_by(12.1F, Vector3f::UnitY());
  expect(0, 1, 1);
  result.detections[0].T_scene_model =
      pose_at(Vector3f::Zero(), 11.9F);  // about the origin, which is far away
  expect(0, 1, 1);
}

TEST_F(Evaluate, CountsATruthAmongTheCandidatesApart) {
  add_truth(Pose::Identity(), "other");
  add_truth(pose_at({40, 0, 0}), "box");
  add_detection(Pose::Identity());
  add_detection(pose_at({40, 0, 0}));
  result.detections[0].candidates = {{.model = "box", .share = 0.6F},
                                     {.model = "other", .share = 0.4F}};
  Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.right, 1U) << "the model named first must be right";
  EXPECT_EQ(evaluation.total.false_positives, 1U);
  EXPECT_EQ(evaluation.total.misnamed, 1U) << "only its name is wrong";
  EXPECT_EQ(evaluation.total.among_candidates, 2U);
  EXPECT_TRUE(evaluation.scenes[0].detections[0].misnamed);

  result.detections[0].candidates[1].T_scene_model = pose_at({5, 0, 0});
  evaluation = judge();
  EXPECT_EQ(evaluation.total.misnamed, 0U) << "the candidate lies elsewhere";
  EXPECT_EQ(evaluation.total.among_candidates, 1U);
}

TEST_F(Evaluate, HoldsTheLeastScoreAgainstTheModelNamedFirstIfThatIsRequired) {
  add_truth(Pose::Identity());
  add_detection(Pose::Identity(), 0.9F);
  result.detections[0].candidates = {{.model = "box", .share = 0.6F},
                                     {.model = "other", .share = 0.4F}};
  const std::vector<std::optional<SceneResult>> results{result};
  EXPECT_EQ(evaluate(manifest, meshes, results, 0.8F, false, false)->total.right, 1U);
  EXPECT_EQ(evaluate(manifest, meshes, results, 0.8F, false, true)->total.right, 0U);
  EXPECT_EQ(evaluate(manifest, meshes, results, 0.5F, false, true)->total.right, 1U);
}

TEST_F(Evaluate, CountsASecondDetectionOfOneInstanceAsFalse) {
  add_truth(Pose::Identity());
  add_detection(Pose::Identity(), 0.5F);
  add_detection(off_by(5, Vector3f::UnitX()), 0.8F);
  const Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.right, 1U);
  EXPECT_EQ(evaluation.total.false_positives, 1U);
  ASSERT_EQ(evaluation.scenes[0].detections.size(), 2U);
  EXPECT_EQ(evaluation.scenes[0].detections[0].detection, 1U) << "the higher score chooses first";
  EXPECT_EQ(evaluation.scenes[0].detections[0].verdict, Verdict::right);
  EXPECT_EQ(evaluation.scenes[0].detections[1].verdict, Verdict::wrong);
}

TEST_F(Evaluate, GivesEachDetectionTheTruthItFitsBest) {
  add_truth(pose_at({0.5F, 0, 0}));
  add_truth(pose_at({0, 0, 0}));
  add_detection(pose_at({0.1F, 0, 0}), 0.9F);
  add_detection(pose_at({0.6F, 0, 0}), 0.8F);
  const Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.right, 2U);
  EXPECT_EQ(*evaluation.scenes[0].detections[0].truth, 1U);
  EXPECT_EQ(*evaluation.scenes[0].detections[1].truth, 0U);
}

TEST_F(Evaluate, DoesNotConfuseModels) {
  add_truth(Pose::Identity(), "other");
  add_detection(Pose::Identity(), 0.9F, "box");
  expect(0, 1, 1);
}

TEST_F(Evaluate, CountsIgnoredTruthsNeitherWay) {
  add_truth(Pose::Identity(), "box", {}, true);
  expect(0, 0, 0);
  add_detection(Pose::Identity());
  expect(0, 0, 0);
  EXPECT_EQ(judge().scenes[0].detections[0].verdict, Verdict::neutral);
}

TEST_F(Evaluate, CountsModelsThatAreNotScoredNeitherWay) {
  manifest.models_scored = {"box"};
  add_truth(Pose::Identity(), "other");
  expect(0, 0, 0);
  add_detection(pose_at({5, 0, 0}), 0.9F, "other");
  expect(0, 0, 0);
}

TEST_F(Evaluate, AcceptsDeclaredSymmetriesOnly) {
  add_truth(pose_at({1, 2, 3}, 30));
  add_detection(pose_at({1, 2, 3}, 30) * off_by(180, Vector3f::UnitZ()));
  expect(0, 1, 1);
  declare({{off_by(180, Vector3f::UnitZ())}, {}, true});
  expect(1, 1, 0);
  EXPECT_EQ(judge().total.add_right, 1U) << "the nearest vertices coincide";
}

TEST_F(Evaluate, LeavesTheTurnAboutAFreeAxisOut) {
  Symmetry symmetry;
  symmetry.axis = Symmetry::Axis{Vector3f::UnitZ(), Vector3f(10, 10, 0)};
  declare(symmetry);
  add_truth(Pose::Identity());
  add_detection(off_by(77, Vector3f::UnitZ()));
  expect(1, 1, 0);
  result.detections[0].T_scene_model = off_by(13, Vector3f::UnitX());
  expect(0, 1, 1);
}

TEST_F(Evaluate, MeasuresAddOnTheVertices) {
  add_truth(Pose::Identity());
  // The corners lie sqrt(1 + 1.5^2) from the z axis through the center: 12 degrees move them by
  // 0.38, and with a shift of 0.65 along z by 0.75 > 0.7, although both errors are within their
  // limits.
  add_detection(off_by(11.9F, Vector3f::UnitZ(), {0, 0, 0.65F}));
  const Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.right, 1U);
  EXPECT_EQ(evaluation.total.add_right, 0U);
  EXPECT_NEAR(*evaluation.median_translation_error, 0.65 / 7, 1e-5);
  EXPECT_NEAR(*evaluation.median_rotation_error_deg, 11.9, 1e-3);
}

TEST_F(Evaluate, CountsTruthsOfScenesWithoutResultAsMissed) {
  add_truth(Pose::Identity());
  const std::vector<std::optional<SceneResult>> none(1);
  const Result<Evaluation> evaluation = evaluate(manifest, meshes, none);
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->num_missing, 1U);
  EXPECT_EQ(evaluation->total.instances, 1U);
  EXPECT_EQ(evaluation->scenes[0].missed, std::vector<std::size_t>{0});
  EXPECT_FALSE(evaluation->median_translation_error);
}

TEST_F(Evaluate, RefusesToScoreAModelThatIsNotListed) {
  manifest.models_scored = {"box", "spoon"};
  const std::vector<std::optional<SceneResult>> results{result};
  const Result<Evaluation> evaluation = evaluate(manifest, meshes, results);
  ASSERT_FALSE(evaluation);
  EXPECT_EQ(evaluation.error().code, ErrorCode::bad_data);
  EXPECT_NE(evaluation.error().message.find("'spoon'"), std::string::npos);
}

TEST_F(Evaluate, CountsDetectionsOfUnknownModelsNeitherWay) {
  add_truth(Pose::Identity(), "spoon");
  add_detection(Pose::Identity(), 0.9F, "spoon");
  add_detection(Pose::Identity(), 0.8F, "fork");
  expect(0, 0, 0);
}

TEST_F(Evaluate, KeepsDetectionsBelowTheThresholdOutOfTheSums) {
  add_truth(Pose::Identity());
  add_truth(pose_at({50, 0, 0}));
  add_detection(Pose::Identity(), 0.5F);
  add_detection(pose_at({50, 0, 0}), 0.3F);
  add_detection(pose_at({90, 0, 0}), 0.2F);
  const Evaluation evaluation = judge(0.5F);
  EXPECT_EQ(evaluation.total.right, 1U);
  EXPECT_EQ(evaluation.total.false_positives, 0U);
  EXPECT_EQ(evaluation.scenes[0].missed, std::vector<std::size_t>{1});
  EXPECT_EQ(evaluation.scenes[0].truths[1].found_by, 1U);
  EXPECT_FALSE(evaluation.scenes[0].detections[1].reported);
  ASSERT_EQ(evaluation.curve.points.size(), 3U) << "the curve has all";
  EXPECT_EQ(evaluation.curve.points[1].recall, 1);
  EXPECT_NEAR(evaluation.curve.points[2].precision, 2.0 / 3, 1e-12);
}

// A threshold always removes the end of the list: the judgment of the other poses does not change.
TEST_F(Evaluate, HoldsTheThresholdAgainstTheVeryPoseWhereThatIsRequired) {
  add_truth(Pose::Identity());
  add_detection(Pose::Identity(), 0.9F);
  result.detections[0].pose_share = 0.5F;
  EXPECT_EQ(judge(0.8F).total.right, 1U);
  EXPECT_EQ(judge(0.8F, true).total.right, 0U);
  const Evaluation open = judge(0.4F, true);
  EXPECT_EQ(open.total.right, 1U);
  ASSERT_TRUE(open.curve.best_f1);
  EXPECT_FLOAT_EQ(static_cast<float>(open.curve.best_f1->score), 0.45F);
}

TEST_F(Evaluate, JudgesReportedDetectionsTheSameWithAndWithoutTheOthers) {
  for (int i = 0; i < 6; ++i) add_truth(pose_at({static_cast<float>(i), 0, 0}));
  for (int i = 0; i < 20; ++i) {
    const float step = static_cast<float>(i * 7 % 20);
    add_detection(pose_at({0.31F * step, 0.01F * step, 0}), 0.05F * static_cast<float>(i + 1));
  }
  const Evaluation all = judge(0.5F);
  std::erase_if(result.detections,
                [](const Detection& detection) { return detection.score < 0.5F; });
  const Evaluation reported = judge();
  EXPECT_EQ(all.total.right, reported.total.right);
  EXPECT_EQ(all.total.false_positives, reported.total.false_positives);
  EXPECT_EQ(all.scenes[0].missed, reported.scenes[0].missed);
}

TEST_F(Evaluate, NamesTheTruthThatAWrongDetectionIsNearestTo) {
  add_truth(pose_at({50, 0, 0}));
  add_truth(Pose::Identity());
  add_truth(Pose::Identity(), "other");
  add_detection(pose_at({1.4F, 0, 0}));
  add_detection(Pose::Identity(), 0.8F, "box");
  const Evaluation evaluation = judge();
  const JudgedDetection& wrong = evaluation.scenes[0].detections[0];
  EXPECT_EQ(wrong.verdict, Verdict::wrong);
  EXPECT_FALSE(wrong.found);
  EXPECT_EQ(wrong.truth, 1U);
  EXPECT_NEAR(wrong.translation_error, 0.2, 1e-6);
  EXPECT_NEAR(wrong.add, 0.2, 1e-6) << "a mere shift moves every vertex by it";
}

TEST_F(Evaluate, SortsInstancesByOcclusionAndModel) {
  add_truth(Pose::Identity(), "other", 0.7);
  add_truth(pose_at({50, 0, 0}), "box", 0.1);
  add_truth(pose_at({90, 0, 0}), "box", 0.95);
  add_truth(pose_at({130, 0, 0}), "box");
  add_detection(pose_at({50, 0, 0}));
  const Evaluation evaluation = judge();
  ASSERT_EQ(evaluation.by_occlusion.size(), 4U);
  EXPECT_EQ(evaluation.by_occlusion[0].first, "<60%");
  EXPECT_EQ(evaluation.by_occlusion[0].second.right, 1U);
  EXPECT_EQ(evaluation.by_occlusion[1].first, "70-80%");
  EXPECT_EQ(evaluation.by_occlusion[2].first, ">84%");
  EXPECT_EQ(evaluation.by_occlusion[3].first, "unknown");
  ASSERT_EQ(evaluation.by_model.size(), 2U);
  EXPECT_EQ(evaluation.by_model[0].first, "box");
  EXPECT_EQ(evaluation.by_model[0].second.instances, 3U);
  EXPECT_TRUE(evaluation.by_clutter.empty()) << "no truth states it";
}

TEST_F(Evaluate, SortsInstancesByClutterAndVisibleFraction) {
  for (const auto& [clutter, visible] :
       {std::pair{0.5, 0.9}, {0.6, 0.2}, {0.96, 0.19}, {0.85, 0.21}}) {
    add_truth(pose_at({static_cast<float>(100 * clutter), 0, 0}));
    manifest.scenes[0].truth.back().clutter = clutter;
    manifest.scenes[0].truth.back().visible_fraction = visible;
  }
  add_detection(pose_at({60, 0, 0}));
  const Evaluation evaluation = judge();
  const auto names = [](const Tallies& tallies) {
    std::vector<std::string> out;
    for (const auto& [name, tally] : tallies) out.push_back(name);
    return out;
  };
  EXPECT_EQ(names(evaluation.by_clutter),
            (std::vector<std::string>{"<60%", "60-80%", "80-90%", ">95%"}));
  EXPECT_EQ(names(evaluation.by_visible_fraction),
            (std::vector<std::string>{"<20%", "20-40%", ">80%"}));
  EXPECT_EQ(evaluation.by_clutter[1].second.right, 1U);
  EXPECT_EQ(evaluation.by_visible_fraction[1].second.right, 1U);
  EXPECT_EQ(evaluation.by_visible_fraction[1].second.instances, 2U);
}

TEST_F(Evaluate, GivesMedianAndNinetyFifthPercentileOfTheTimes) {
  manifest.scenes.resize(5);
  std::vector<std::optional<SceneResult>> results(5, SceneResult{});
  for (std::size_t s = 0; s < 3; ++s) {
    results[s]->stats.times.add("vote", 1.0 + static_cast<double>(s));
    results[s]->stats.total_seconds = 3.0 + static_cast<double>(2 * s);
  }
  results[4].reset();  // and the fourth result has no times
  const Result<Evaluation> evaluation = evaluate(manifest, meshes, results);
  ASSERT_TRUE(evaluation);
  ASSERT_EQ(evaluation->seconds.size(), 2U);
  EXPECT_EQ(evaluation->seconds[0].stage, "vote");
  EXPECT_DOUBLE_EQ(evaluation->seconds[0].median, 2);
  EXPECT_DOUBLE_EQ(evaluation->seconds[0].p95, 2.9);
  EXPECT_EQ(evaluation->seconds[1].stage, "total");
  EXPECT_DOUBLE_EQ(evaluation->seconds[1].median, 5);
  EXPECT_DOUBLE_EQ(evaluation->seconds[1].p95, 6.8);
}

}  // namespace
}  // namespace trivet
