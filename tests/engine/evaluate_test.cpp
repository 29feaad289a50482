#include "engine/evaluate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "engine/manifest_inputs.hpp"
#include "engine/train.hpp"
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

/// One scene in metres; a library of a box of 2 x 3 x 6 (diameter 7) far from its origin, and its
/// twin `other`.
class Evaluate : public testing::Test {
 protected:
  Evaluate() {
    const test::Shape shape = test::box({9, 8.5F, 7}, {11, 11.5F, 13});
    for (const char* name : {"box", "other"}) {
      Model model;
      model.name = name;
      model.vertices = shape.vertices;
      model.diameter = 7;
      library.models.push_back(std::move(model));
      manifest.models.push_back({name, "", 1, {}});
    }
    manifest.scenes.resize(1);
  }

  void add_truth(const Pose& pose, const char* model = "box", std::optional<double> occlusion = {},
                 bool ignore = false) {
    manifest.scenes[0].truth.push_back({model, pose, occlusion, ignore});
  }
  void add_detection(const Pose& pose, float score = 0.9F, const char* model = "box") {
    Detection detection;
    detection.model = model;
    detection.score = score;
    detection.T_scene_model = pose;
    result.detections.push_back(detection);
  }
  Evaluation judge() {
    const std::vector<std::optional<SceneResult>> results{result};
    Result<Evaluation> evaluation = evaluate(manifest, library, results);
    EXPECT_TRUE(evaluation) << evaluation.error().message;
    return *evaluation;
  }
  void expect(std::size_t right, std::size_t instances, std::size_t false_positives) {
    const Evaluation evaluation = judge();
    EXPECT_EQ(evaluation.total.right, right);
    EXPECT_EQ(evaluation.total.instances, instances);
    EXPECT_EQ(evaluation.total.false_positives, false_positives);
  }
  /// Turn about the middle of the box by so many degrees, then shift.
  static Pose off_by(float angle_deg, const Vector3f& axis,
                     const Vector3f& shift = Vector3f::Zero()) {
    const Vector3f middle(10, 10, 10);
    return pose_at(shift + middle, angle_deg, axis) * pose_at(-middle);
  }

  Manifest manifest;
  Library library;
  SceneResult result;
};

TEST_F(Evaluate, TakesTheTruthItselfForRight) {
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
      pose_at(Vector3f::Zero(), 11.9F);  // about the origin, which is far
  expect(0, 1, 1);
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

TEST_F(Evaluate, DoesNotTakeOneModelForAnother) {
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
  manifest.models[0].symmetry = Symmetry{{off_by(180, Vector3f::UnitZ())}, {}, true};
  expect(1, 1, 0);
  EXPECT_EQ(judge().total.add_right, 1U) << "the nearest vertices coincide";
}

TEST_F(Evaluate, LeavesTheTurnAboutAFreeAxisOut) {
  Symmetry symmetry;
  symmetry.axis = Symmetry::Axis{Vector3f::UnitZ(), Vector3f(10, 10, 0)};
  manifest.models[0].symmetry = symmetry;
  add_truth(Pose::Identity());
  add_detection(off_by(77, Vector3f::UnitZ()));
  expect(1, 1, 0);
  result.detections[0].T_scene_model = off_by(13, Vector3f::UnitX());
  expect(0, 1, 1);
}

TEST_F(Evaluate, MeasuresAddOnTheVertices) {
  add_truth(Pose::Identity());
  // The corners lie sqrt(1 + 1.5^2) from the z axis through the middle: 12 degrees move them by
  // 0.38, with 0.65 along z by 0.75 > 0.7, although both errors are within their limits.
  add_detection(off_by(11.9F, Vector3f::UnitZ(), {0, 0, 0.65F}));
  const Evaluation evaluation = judge();
  EXPECT_EQ(evaluation.total.right, 1U);
  EXPECT_EQ(evaluation.total.add_right, 0U);
  EXPECT_NEAR(*evaluation.median_translation_error, 0.65 / 7, 1e-5);
  EXPECT_NEAR(*evaluation.median_rotation_error_deg, 11.9, 1e-3);
}

TEST_F(Evaluate, ConvertsTheLibrarysUnit) {
  manifest.unit = LengthUnit::millimetre;  // the library is in metres: the box is 7000 across
  add_truth(pose_at({1000, 0, 0}));
  add_detection(pose_at({1690, 0, 0}));
  expect(1, 1, 0);
  result.detections[0].T_scene_model = pose_at({1710, 0, 0});
  expect(0, 1, 1);
}

TEST_F(Evaluate, CountsTruthsOfScenesWithoutResultAsMissed) {
  add_truth(Pose::Identity());
  const std::vector<std::optional<SceneResult>> none(1);
  const Result<Evaluation> evaluation = evaluate(manifest, library, none);
  ASSERT_TRUE(evaluation);
  EXPECT_EQ(evaluation->num_missing, 1U);
  EXPECT_EQ(evaluation->total.instances, 1U);
  EXPECT_EQ(evaluation->scenes[0].missed, std::vector<std::size_t>{0});
  EXPECT_FALSE(evaluation->median_translation_error);
}

TEST_F(Evaluate, RefusesDetectionsOfAModelThatTheLibraryLacks) {
  add_truth(Pose::Identity(), "box");
  add_detection(Pose::Identity());
  library.models.clear();
  const std::vector<std::optional<SceneResult>> results{result};
  const Result<Evaluation> evaluation = evaluate(manifest, library, results);
  ASSERT_FALSE(evaluation);
  EXPECT_EQ(evaluation.error().code, ErrorCode::bad_data);
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
}

TEST_F(Evaluate, GivesMedianTimesOfTheStages) {
  manifest.scenes.resize(2);
  std::vector<std::optional<SceneResult>> results(2, SceneResult{});
  for (std::size_t s = 0; s < 2; ++s) {
    results[s]->stats.times.add("vote", 1.0 + static_cast<double>(s));
    results[s]->stats.total_seconds = 3.0 + static_cast<double>(s);
  }
  const Result<Evaluation> evaluation = evaluate(manifest, library, results);
  ASSERT_TRUE(evaluation);
  const std::vector<std::pair<std::string, double>> expected{{"vote", 1.5}, {"total", 3.5}};
  EXPECT_EQ(evaluation->median_seconds.seconds, expected);
}

// Ends of the interval are the roots p of |right / n - p| = z sqrt(p (1 - p) / n).
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
