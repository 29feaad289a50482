#include "engine/evaluation/bop_scores.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "engine/common/thread_limit.hpp"
#include "storage/formats/write_png.hpp"
#include "support/random.hpp"
#include "support/shapes.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

using Eigen::Vector3f;

Pose at(float x, float y = 0, float z = 600) { return Pose(Eigen::Translation3f(x, y, z)); }

constexpr std::uint32_t kWidth = 64, kHeight = 48;

/// Depth images of 64 x 48 pixels in mm, with a wall at 2 m, a plate of 100 x 100 x 20 whose near
/// side lies at z = 0, and its twin `other`. Thresholds are fractions of 100 mm.
class BopScoresTest : public testing::Test {
 protected:
  BopScoresTest() {
    const test::Shape plate = test::box({-50, -50, 0}, {50, 50, 20});
    for (const char* name : {"plate", "other"}) {
      meshes.push_back({name, plate.vertices, plate.triangles, 100, {}});
      manifest.models.push_back({name, "", 1, {}});
    }
    manifest.unit = LengthUnit::millimeter;
    add_scene(2000);
  }

  void add_scene(std::uint16_t measured) {
    ManifestScene scene;
    scene.name = "scene" + std::to_string(manifest.scenes.size());
    scene.camera = Camera{64, 64, 31.5, 23.5, 1};
    manifest.scenes.push_back(scene);
    results.emplace_back(SceneResult{});
    measure(measured);
  }
  /// Sets the last scene's depth at every pixel but the first, as no image may be empty.
  void measure(std::uint16_t depth) {
    ManifestScene& scene = manifest.scenes.back();
    scene.file = folder / scene.name += ".png";
    std::vector<std::uint16_t> depths(kWidth * kHeight, depth);
    depths[0] = 2000;
    ASSERT_TRUE(write_depth_png(scene.file, depths, kWidth));
  }
  void add_truth(const Pose& pose, std::optional<double> visible = {},
                 const char* model = "plate") {
    manifest.scenes.back().truth.push_back({model, pose, {}, false, visible});
  }
  void add_detection(const Pose& pose, float score = 0.9F, const char* model = "plate") {
    Detection detection;
    detection.model = model;
    detection.score = score;
    detection.T_scene_model = pose;
    results.back()->detections.push_back(detection);
  }
  BopScores score(const BopOptions& options = {}) const {
    const Result<BopScores> scores = bop_scores(manifest, meshes, results, options);
    EXPECT_TRUE(scores) << scores.error().message;
    return *scores;
  }
  void expect_mssd(double recall, double precision) const {
    const BopScores scores = score();
    EXPECT_NEAR(scores.localization.mssd, recall, 1e-12);
    EXPECT_NEAR(scores.detection.mssd, precision, 1e-12);
  }

  const test::TempDir folder;
  Manifest manifest;
  std::vector<EvaluationMesh> meshes;
  std::vector<std::optional<SceneResult>> results;
};

TEST_F(BopScoresTest, GivesFullMarksForTheTruthItself) {
  add_truth(at(0));
  add_detection(at(0));
  const BopScores scores = score();
  EXPECT_EQ(scores.localization.num_targets, 1U);
  EXPECT_EQ(scores.localization.vsd, 1);
  EXPECT_EQ(scores.localization.mssd, 1);
  EXPECT_EQ(scores.localization.mspd, 1);
  EXPECT_EQ(scores.localization.mean, 1);
  EXPECT_EQ(scores.detection.num_targets, 1U);
  EXPECT_EQ(scores.detection.mssd, 1);
  EXPECT_EQ(scores.detection.mspd, 1);
  EXPECT_EQ(scores.detection.mean, 1);
  EXPECT_EQ(scores.detection.mssd_mm, 1);
}

// 12 mm are below 8 of the thresholds 5, 10 ... 50 mm and 4 of 2, 4 ... 20 mm. In the image, at z =
// 600, they are 64 * 12 / 600 = 1.28 pixels of 64, 12.8 of 640: below 8 of 5, 10 ... 50.
TEST_F(BopScoresTest, CountsTheThresholdsAboveTheError) {
  add_truth(at(0));
  add_detection(at(12));
  const BopScores scores = score();
  EXPECT_NEAR(scores.localization.mssd, 0.8, 1e-12);
  EXPECT_NEAR(*scores.localization.mspd, 0.8, 1e-12);
  EXPECT_NEAR(scores.detection.mssd, 0.8, 1e-12);
  EXPECT_NEAR(*scores.detection.mspd, 0.8, 1e-12);
  EXPECT_NEAR(*scores.detection.mean, 0.8, 1e-12);
  EXPECT_NEAR(scores.detection.mssd_mm, 0.4, 1e-12);
  ASSERT_TRUE(scores.errors[0][0]);
  EXPECT_EQ(scores.errors[0][0]->truth, 0U);
  EXPECT_NEAR(scores.errors[0][0]->mssd, 12, 1e-9);
  EXPECT_NEAR(*scores.errors[0][0]->mspd, 12.8, 1e-9);
}

TEST_F(BopScoresTest, DoesNotCountAThresholdThatIsJustMet) {
  add_truth(at(0));
  add_detection(at(25));
  EXPECT_NEAR(score().localization.mssd, 0.5, 1e-12);  // 0.3 to 0.5
}

// Along the rays the plate is 12 to 12.1 mm farther away: wrong at 2 of 10 tolerances, right at all
// others, since both poses fill the same 10 x 10 pixels.
TEST_F(BopScoresTest, AveragesVsdOverTolerancesAndThresholds) {
  add_truth(at(0));
  add_detection(at(0, 0, 612));
  const BopScores scores = score();
  EXPECT_NEAR(*scores.localization.vsd, 0.8, 1e-12);
  EXPECT_EQ((*scores.errors[0][0]->vsd)[1], 1);
  EXPECT_EQ((*scores.errors[0][0]->vsd)[2], 0);
}

TEST_F(BopScoresTest, KnowsThatVsdOfPosesApartIsOne) {
  add_truth(at(-150));
  add_detection(at(150));
  EXPECT_EQ(score().localization.vsd, 0);
  EXPECT_EQ((*score().errors[0][0]->vsd)[9], 1);
}

TEST_F(BopScoresTest, TreatsMissingDepthAsVisibleAndAnOccluderAsHiding) {
  add_truth(at(0));
  add_detection(at(0));
  measure(0);
  EXPECT_EQ(score().localization.vsd, 1);
  measure(400);
  EXPECT_EQ(score().localization.vsd, 0) << "nothing of the plate is visible";
  EXPECT_EQ(score().localization.mssd, 1);
}

// The plate lies 10 mm behind the measured surface.
TEST_F(BopScoresTest, ReadsTheDeltaOfVsdInMillimeters) {
  add_truth(at(0));
  add_detection(at(0));
  measure(590);
  EXPECT_EQ(score().localization.vsd, 1);
  EXPECT_EQ(score({.vsd_delta_mm = 5}).localization.vsd, 0);
}

TEST_F(BopScoresTest, AcceptsSymmetries) {
  Pose turned = at(0);
  turned.linear() =
      Eigen::AngleAxisf(std::numbers::pi_v<float>, Vector3f::UnitZ()).toRotationMatrix();
  add_truth(at(0));
  add_detection(turned);
  expect_mssd(0, 0);  // its corners are 141 mm off
  Pose half = turned;
  half.translation().setZero();
  meshes[0].symmetry.poses = {half};
  expect_mssd(1, 1);
  EXPECT_EQ(score().localization.mspd, 1);
  meshes[0].symmetry = {{}, Symmetry::Axis{}, true};
  expect_mssd(1, 1);
}

TEST_F(BopScoresTest, LocalizesWithAsManyDetectionsAsThereAreTargets) {
  add_truth(at(0));
  add_detection(at(-150), 0.9F);
  add_detection(at(0), 0.8F);
  expect_mssd(0, 0.5);
  manifest.scenes[0].targets = {{"plate", 2}};
  expect_mssd(1, 0.5);
  EXPECT_EQ(score().localization.num_targets, 1U) << "there is one, whatever the targets say";
  manifest.scenes[0].targets = {{"other", 1}};
  expect_mssd(0, 0.5);
  EXPECT_EQ(score().localization.num_targets, 0U);
}

TEST_F(BopScoresTest, CountsMissingDetectionsAsNotFound) {
  add_truth(at(0));
  add_truth(at(-150));
  add_detection(at(0));
  expect_mssd(0.5, 51.0 / 101);  // recalls 0 to 0.5 are reached
  results[0].reset();
  expect_mssd(0, 0);
  EXPECT_EQ(score().localization.num_targets, 2U);
}

TEST_F(BopScoresTest, SearchesTheMostVisibleInstances) {
  manifest.scenes[0].targets = {{"plate", 1}};
  add_truth(at(-150), 0.3);
  add_truth(at(0), 0.9);
  add_truth(at(150), 0.9);
  add_detection(at(-150));
  EXPECT_EQ(score().localization.mssd, 0);
  results[0]->detections[0].T_scene_model = at(0);
  EXPECT_EQ(score().localization.mssd, 1) << "the first of equally visible ones";
  results[0]->detections[0].T_scene_model = at(150);
  EXPECT_EQ(score().localization.mssd, 0);
}

// Localization ignores the hidden instance; detection is not affected.
TEST_F(BopScoresTest, LeavesOutWhatIsVisibleByLessThanATenth) {
  add_truth(at(-150), 0.099);
  add_truth(at(0), 0.1);
  add_detection(at(0), 0.5F);
  EXPECT_EQ(score().localization.num_targets, 1U);
  EXPECT_EQ(score().detection.num_targets, 1U);
  expect_mssd(1, 1);
  add_detection(at(-150), 0.9F);
  expect_mssd(0, 1);  // it uses the only detection allowed for localization
  add_detection(at(-150), 0.8F);
  expect_mssd(0, 0.5);  // a second detection of the hidden instance is false
}

TEST_F(BopScoresTest, TreatsIgnoredTruthsAsHiddenWhereVisibilityIsUnknown) {
  add_truth(at(0));
  add_truth(at(-150));
  manifest.scenes[0].truth[1].ignore = true;
  EXPECT_EQ(score().localization.num_targets, 1U);
  manifest.scenes[0].truth[1].visible_fraction = 0.2;
  EXPECT_EQ(score().localization.num_targets, 2U);
}

TEST_F(BopScoresTest, GivesEachDetectionOneTruth) {
  add_truth(at(0));
  add_truth(at(1));
  add_detection(at(0));
  expect_mssd(0.5, 51.0 / 101);
}

// The better-scored detection, 10 mm from the first truth, matches it at every larger threshold.
// The other, which is exact, must then match the second truth, 40 mm away. Both are right at
// thresholds of 45 and 50 mm, otherwise one is.
TEST_F(BopScoresTest, MatchesByFallingScore) {
  add_truth(at(0));
  add_truth(at(40));
  add_detection(at(0), 0.5F);
  add_detection(at(-10), 0.9F);
  EXPECT_NEAR(score().localization.mssd, 0.6, 1e-12);
}

TEST_F(BopScoresTest, BreaksTiesByTheOrderOfTheDetections) {
  add_truth(at(0));
  add_detection(at(0));
  add_detection(at(150));
  expect_mssd(1, 1);
  std::swap(results[0]->detections[0], results[0]->detections[1]);
  expect_mssd(0, 0.5);
}

TEST_F(BopScoresTest, AveragesRecallOverInstancesAndPrecisionOverModels) {
  for (const float x : {-150.0F, 0.0F, 150.0F}) {
    add_truth(at(x));
    add_detection(at(x));
  }
  add_scene(2000);
  add_truth(at(0), {}, "other");
  expect_mssd(0.75, 0.5);
}

TEST_F(BopScoresTest, RanksDetectionsOfAllImages) {
  add_truth(at(0));
  add_detection(at(0), 0.6F);
  add_scene(2000);
  add_truth(at(0));
  add_detection(at(150), 0.7F);
  expect_mssd(0.5, 51 * 0.5 / 101);  // false, right, one missed
}

// The toolkit drops them as well.
TEST_F(BopScoresTest, DropsDetectionsOfModelsThatTheImageLacks) {
  add_truth(at(0));
  add_detection(at(0), 0.5F);
  add_detection(at(0), 0.9F, "other");
  add_scene(2000);
  add_truth(at(0), {}, "other");
  add_detection(at(0), 0.5F, "other");
  add_detection(at(0), 0.9F, "plate");
  expect_mssd(1, 1);
  EXPECT_EQ(score().detection.num_absent, 2U);
  EXPECT_FALSE(score().errors[0][1]);
}

TEST_F(BopScoresTest, CountsAHundredDetectionsPerImage) {
  add_truth(at(0));
  add_detection(at(0), 0.1F);
  for (int i = 0; i < 99; ++i) add_detection(at(150), 0.9F, i % 2 == 0 ? "plate" : "other");
  expect_mssd(0, 1.0 / 51);
  EXPECT_EQ(score().detection.num_absent, 49U);
  add_detection(at(150), 0.9F, "other");
  expect_mssd(0, 0);
}

TEST_F(BopScoresTest, LeavesOutModelsThatAreNotScored) {
  manifest.models_scored = {"plate"};
  meshes.pop_back();
  add_truth(at(0));
  add_truth(at(150), {}, "other");
  for (int i = 0; i < 200; ++i) add_detection(at(0), 0.9F, "other");
  add_detection(at(0), 0.5F);
  expect_mssd(1, 1);
  EXPECT_EQ(score().detection.num_absent, 0U);
}

TEST_F(BopScoresTest, HasNoVsdAndMspdWithoutADepthImage) {
  add_truth(at(0));
  add_detection(at(12));
  manifest.scenes[0].file = folder / "absent.ply";
  for (int camera = 0; camera < 2; ++camera) {
    const BopScores scores = score();
    EXPECT_FALSE(scores.localization.vsd);
    EXPECT_FALSE(scores.localization.mspd);
    EXPECT_FALSE(scores.localization.mean);
    EXPECT_FALSE(scores.detection.mspd);
    EXPECT_FALSE(scores.detection.mean);
    EXPECT_NEAR(scores.localization.mssd, 0.8, 1e-12);
    EXPECT_NEAR(scores.detection.mssd_mm, 0.4, 1e-12);
    EXPECT_FALSE(scores.errors[0][0]->mspd);
    EXPECT_FALSE(scores.errors[0][0]->vsd);
    manifest.scenes[0].camera.reset();
  }
}

TEST_F(BopScoresTest, CountsForVsdAndMspdOnlyScenesWithADepthImage) {
  add_truth(at(0));
  add_detection(at(0));
  add_scene(2000);
  add_truth(at(0));
  manifest.scenes[1].camera.reset();
  const BopScores scores = score();
  EXPECT_EQ(scores.localization.vsd, 1);
  EXPECT_EQ(scores.localization.mspd, 1);
  EXPECT_EQ(scores.localization.mssd, 0.5);
  EXPECT_EQ(scores.detection.mspd, 1);
  EXPECT_NEAR(scores.detection.mssd, 51.0 / 101, 1e-12);
}

TEST_F(BopScoresTest, HasNoVsdOfAMeshWithoutFaces) {
  add_truth(at(0));
  add_truth(at(150), {}, "other");
  add_detection(at(0));
  meshes[1].triangles = {};
  EXPECT_EQ(score().localization.vsd, 1) << "of the plate alone";
  EXPECT_EQ(score().localization.mspd, 0.5);
  meshes[0].triangles = {};
  EXPECT_FALSE(score().localization.vsd);
  EXPECT_FALSE(score().localization.mean);
}

TEST_F(BopScoresTest, NamesTheNearestTruthOfEachDetection) {
  add_truth(at(150), {}, "other");
  add_truth(at(-150));
  add_truth(at(150));
  add_detection(at(130));
  EXPECT_EQ(score().errors[0][0]->truth, 2U);
  EXPECT_NEAR(score().errors[0][0]->mssd, 20, 1e-9);
}

TEST_F(BopScoresTest, GivesTheSameInMeters) {
  add_truth(at(0));
  add_detection(at(12, 0, 604));
  const BopScores in_mm = score();
  manifest.unit = LengthUnit::meter;
  manifest.scenes[0].camera->depth_scale = 0.001;
  for (EvaluationMesh& mesh : meshes) {
    Points vertices(mesh.vertices);
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices.set(i, 0.001F * vertices[i]);
    mesh.vertices = std::move(vertices);
    mesh.diameter *= 0.001;
  }
  manifest.scenes[0].truth[0].T_scene_model.translation() *= 0.001F;
  results[0]->detections[0].T_scene_model.translation() *= 0.001F;
  const BopScores in_m = score();
  EXPECT_EQ(in_m.localization.vsd, in_mm.localization.vsd);
  EXPECT_EQ(in_m.localization.mssd, in_mm.localization.mssd);
  EXPECT_EQ(in_m.localization.mspd, in_mm.localization.mspd);
  EXPECT_EQ(in_m.detection.mssd_mm, in_mm.detection.mssd_mm);
  EXPECT_NEAR(in_m.errors[0][0]->mssd, 0.001 * in_mm.errors[0][0]->mssd, 1e-8);
}

TEST_F(BopScoresTest, HasNothingToScoreWithoutTruth) {
  add_detection(at(0));
  const BopScores scores = score();
  EXPECT_EQ(scores.localization.num_targets, 0U);
  EXPECT_EQ(scores.localization.mssd, 0);
  EXPECT_EQ(scores.detection.mssd, 0);
  EXPECT_FALSE(scores.localization.vsd);
  EXPECT_EQ(scores.detection.num_absent, 1U);
}

TEST_F(BopScoresTest, RefusesWhatItCannotMeasureOn) {
  const auto message = [&] {
    const Result<BopScores> scores = bop_scores(manifest, meshes, results);
    EXPECT_FALSE(scores);
    EXPECT_EQ(scores.error().code, ErrorCode::bad_data);
    return scores.error().message;
  };
  meshes[1].diameter = 0;
  EXPECT_NE(message().find("'other'"), std::string::npos);
  meshes[1] = {"other", {}, {}, 1, {}};
  EXPECT_NE(message().find("'other'"), std::string::npos);
  meshes.pop_back();
  EXPECT_NE(message().find("'other'"), std::string::npos);
}

TEST_F(BopScoresTest, SaysWhichDepthImageItCannotRead) {
  add_truth(at(0));
  manifest.scenes[0].file = folder / "gone.png";
  const Result<BopScores> scores = bop_scores(manifest, meshes, results);
  ASSERT_FALSE(scores);
  EXPECT_EQ(scores.error().code, ErrorCode::missing_input);
  EXPECT_NE(scores.error().message.find("gone.png"), std::string::npos);
}

TEST_F(BopScoresTest, GivesTheSameBitsForAnyNumberOfThreads) {
  test::Random random;
  for (int s = 0; s < 6; ++s) {
    if (s > 0) add_scene(static_cast<std::uint16_t>(550 + 30 * s));
    for (int i = 0; i < 4; ++i) {
      const Pose truth = at(random.uniform(-150, 150), random.uniform(-100, 100));
      const char* const model = random.below(2) == 0 ? "plate" : "other";
      add_truth(truth, 0.25 * random.below(5), model);
      for (int e = 0; e < 3; ++e) {
        add_detection(truth * random.motion(5) * at(0, 0, random.uniform(-30, 30)),
                      0.1F * static_cast<float>(random.below(10)), model);
      }
    }
  }
  meshes[0].symmetry = {{}, Symmetry::Axis{}, true};
  const auto bits = [&](unsigned num_threads) {
    const ThreadLimit limit(num_threads);
    const BopScores scores = score();
    std::vector<double> numbers{*scores.localization.vsd,  scores.localization.mssd,
                                *scores.localization.mspd, scores.detection.mssd,
                                *scores.detection.mspd,    scores.detection.mssd_mm};
    for (const auto& scene : scores.errors) {
      for (const auto& error : scene) {
        numbers.push_back(error->mssd);
        numbers.push_back(*error->mspd);
        numbers.insert(numbers.end(), error->vsd->begin(), error->vsd->end());
      }
    }
    return numbers;
  };
  const std::vector<double> alone = bits(1);
  EXPECT_GT(alone[0], 0);
  EXPECT_EQ(bits(2), alone);
  EXPECT_EQ(bits(3), alone);
}

}  // namespace
}  // namespace trivet
