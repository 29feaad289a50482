#include "engine/recognize.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>

#include "engine/surface_from_points.hpp"
#include "engine/train.hpp"
#include "engine/verification/candidate.hpp"
#include "kernels/common/pose_math.hpp"
#include "storage/read_cloud.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/temp_dir.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

/// One library of two parts, trained once for all tests here.
class Recognize : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    bracket_ = test::bracket();
    lever_ = test::lever();
    recognizer_ = Recognizer(test::trained_library({{"bracket", &bracket_}, {"lever", &lever_}}));
  }

  /// Two parts in front of a wall, the lever partly behind the bracket.
  static Cloud clutter() {
    static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
    return test::render_scan(
        {{&wall, Pose::Identity()}, {&bracket_, bracket_pose()}, {&lever_, lever_pose()}});
  }
  static Cloud in_millimeters(Cloud scene) {
    const PointsSpan span = scene.points;
    for (const std::span<float> column : {span.x, span.y, span.z}) {
      for (float& value : column) value *= 1000;
    }
    return scene;
  }
  static Pose bracket_pose() { return test::pose_of({2.1F, 0.7F, -0.4F}, {-0.02F, 0.03F, 0.85F}); }
  static Pose lever_pose() { return test::pose_of({-0.6F, 0.5F, 1.9F}, {0.12F, 0.02F, 0.95F}); }

  static const Detection* find(const SceneResult& result, const std::string& model) {
    for (const Detection& detection : result.detections) {
      if (detection.model == model) return &detection;
    }
    return nullptr;
  }
  static void expect_pose(const Detection* found, const Pose& truth, float diameter) {
    ASSERT_NE(found, nullptr);
    const auto error =
        kernels::pose_distance(truth, found->T_scene_model, {}, Eigen::Vector3f::Zero());
    EXPECT_LT(error.translation, 0.01F * diameter);
    EXPECT_LT(error.rotation_rad, 0.02F);
  }

  static inline test::Shape bracket_, lever_;
  static inline Recognizer recognizer_{Library{}};
};

TEST_F(Recognize, FindsOccludedPartsInClutterAndNothingElse) {
  const auto result = recognize(recognizer_, clutter(), {}, {});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->detections.size(), 2U);
  expect_pose(find(*result, "bracket"), bracket_pose(), 0.2F);
  expect_pose(find(*result, "lever"), lever_pose(), 0.2F);
  for (std::size_t i = 1; i < result->detections.size(); ++i) {
    EXPECT_GE(result->detections[i - 1].score, result->detections[i].score);
  }
}

TEST_F(Recognize, FindsTheSamePartsByTriSpinImages) {
  const auto result = recognize(recognizer_, clutter(), {}, {.method = Method::trisi});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->detections.size(), 2U);
  expect_pose(find(*result, "bracket"), bracket_pose(), 0.2F);
  expect_pose(find(*result, "lever"), lever_pose(), 0.2F);
  for (const Detection& detection : result->detections) EXPECT_EQ(detection.source, Source::trisi);
  EXPECT_EQ(result->stats.num_votes, 0U);
  const auto one =
      recognize(recognizer_, clutter(), {}, {.method = Method::trisi, .models = {"lever"}});
  ASSERT_TRUE(one);
  ASSERT_EQ(one->detections.size(), 1U);
  EXPECT_EQ(one->detections[0].model, "lever");
}

TEST_F(Recognize, SearchesByWhatTheLibraryWasTrainedFor) {
  const auto recognize_with = [&](bool pairs, bool images, Method method) {
    const Recognizer recognizer(test::trained_library(
        {{"bracket", &bracket_}}, {.point_pairs = pairs, .tri_spin_images = images}));
    return recognize(recognizer, clutter(), {}, {.method = method});
  };
  for (const auto& [pairs, images] : {std::pair{true, false}, std::pair{false, true}}) {
    const auto fused = recognize_with(pairs, images, Method::fused);
    ASSERT_TRUE(fused) << fused.error().message;
    expect_pose(find(*fused, "bracket"), bracket_pose(), 0.2F);
    EXPECT_EQ(fused->detections[0].source, pairs ? Source::ppf : Source::trisi);
    const auto other = recognize_with(pairs, images, pairs ? Method::trisi : Method::ppf);
    ASSERT_FALSE(other);
    EXPECT_EQ(other.error().code, ErrorCode::usage);
    EXPECT_NE(other.error().message.find(pairs ? "--methods trisi" : "--methods ppf"),
              std::string::npos)
        << other.error().message;
  }
}

TEST_F(Recognize, FindsEachOfSeveralInstances) {
  const Pose left = test::pose_of({0.3F, 2.0F, 0.1F}, {-0.18F, 0, 0.9F});
  const Pose right = test::pose_of({-1.0F, 0.2F, 1.2F}, {0.18F, 0.02F, 0.95F});
  const Cloud scene = test::render_scan({{&bracket_, left}, {&bracket_, right}});
  const auto result = recognize(recognizer_, scene, {}, {});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->detections.size(), 2U);
  RecognizeOptions one;
  one.max_instances = 1;
  const auto limited = recognize(recognizer_, scene, {}, one);
  ASSERT_TRUE(limited);
  EXPECT_EQ(limited->detections.size(), 1U);
}

// What is scored is where the pose settles, not where it started.
TEST_F(Recognize, SettlesToOneResultFromADozenStarts) {
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

// A block with a knob at one end, which something hides: it may as well lie the other way round.
TEST_F(Recognize, NamesThePosesThatFitAlike) {
  test::Shape key = test::box({-0.1F, -0.03F, -0.02F}, {0.1F, 0.03F, 0.02F});
  key.join(test::box({0.07F, -0.02F, 0.02F}, {0.09F, 0.02F, 0.04F}));
  auto trained = train_model(test::cloud_of(key), {"key", "key.ply", 1, {}}, {});
  ASSERT_TRUE(trained) << trained.error().message;
  ASSERT_FALSE(trained->model.near_symmetries.empty());
  Library library;
  library.models.push_back(std::move(trained->model));
  const Recognizer recognizer(std::move(library));
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
  EXPECT_EQ(found.score, kernels::pose_probability(recognizer.score(), found.parts))
      << "that the key is there is as sure as it looks";
}

// A plank whose ends are hidden may lie farther on: no symmetry of it says so.
TEST_F(Recognize, IsLessSureOfWhatMayLieOtherwiseInItsPlace) {
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
  EXPECT_EQ(
      ambiguous.score,
      engine::scale_odds(kernels::pose_probability(recognizer.score(), ambiguous.parts), 0.4F));
}

// A mug looks alike under any turn but for its handle.
TEST_F(Recognize, TurnsAMugToItsHandleAndDoubtsTheTurnWhereThatIsHidden) {
  test::Shape mug = test::prism(60, test::circle(0.04), -0.05, 0.05, 0.035, 0.9);
  mug.join(test::box({0.036F, -0.006F, -0.025F}, {0.065F, 0.006F, 0.025F}));
  auto trained = train_model(test::cloud_of(mug), {"mug", "mug.ply", 1, {}}, {});
  ASSERT_TRUE(trained) << trained.error().message;
  ASSERT_TRUE(trained->model.near_axis);
  Library library;
  library.models.push_back(std::move(trained->model));
  const Recognizer recognizer(std::move(library));
  const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F});
  const auto pose_of = [](float turn) {
    return test::pose_of({1.9F, 0, 0}, {0, 0, 0.6F}) * test::pose_of({0, 0, turn}, {0, 0, 0});
  };
  const auto scan_of = [&](float turn) {
    return test::render_scan({{&wall, Pose::Identity()}, {&mug, pose_of(turn)}});
  };
  const auto look_at = [&](float turn, ImprovementSet ablated = {}) {
    const auto result =
        recognize(recognizer, scan_of(turn), {}, {.min_score = 0, .ablated = ablated});
    EXPECT_TRUE(result && !result->detections.empty());
    return std::pair{pose_of(turn), result->detections.at(0)};
  };
  for (const float turn : {-1.2F, -0.3F, 0.4F, 2.9F}) {
    const auto [pose, found] = look_at(turn);
    EXPECT_LT(kernels::rotation_angle(pose.linear(), found.T_scene_model.linear()), 0.04F) << turn;
    EXPECT_GT(found.score, 0.8F) << turn;
    EXPECT_TRUE(found.alternatives.empty()) << turn;
    EXPECT_GT(found.pose_share, 0.95F) << turn;
    EXPECT_FALSE(found.turns) << turn;
  }
  constexpr float kBehind = 1.57F;
  const Detection hidden = look_at(kBehind).second;
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
  const Detection unambiguous = look_at(kBehind, {Improvement::alternatives}).second;
  EXPECT_EQ(unambiguous.score, kernels::pose_probability(recognizer.score(), unambiguous.parts));
  EXPECT_TRUE(unambiguous.alternatives.empty());
  EXPECT_EQ(unambiguous.pose_share, 1);
  EXPECT_FALSE(unambiguous.turns);

  // Whoever needs the very pose is not given it; the mug alone is there.
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
  EXPECT_EQ(refused.rejected[0].score, hidden.score) << "of the object";
}

TEST_F(Recognize, GivesTheSameBytesForAnyNumberOfThreads) {
  const Cloud scene = clutter();
  for (const Method method : {Method::fused, Method::ppf, Method::trisi}) {
    std::vector<SceneResult> results;
    for (const unsigned threads : {1U, 2U, 3U}) {
      const ThreadLimit limit(threads);
      const Recognizer fresh(recognizer_.library());
      auto result = recognize(fresh, scene, {}, {.method = method, .min_score = 0});
      ASSERT_TRUE(result);
      results.push_back(std::move(*result));
    }
    for (std::size_t k = 1; k < results.size(); ++k) {
      EXPECT_EQ(results[k].stats.num_votes, results[0].stats.num_votes);
      ASSERT_EQ(results[k].detections.size(), results[0].detections.size());
      for (std::size_t i = 0; i < results[0].detections.size(); ++i) {
        EXPECT_EQ(results[k].detections[i].score, results[0].detections[i].score);
        EXPECT_EQ(results[k].detections[i].T_scene_model.matrix(),
                  results[0].detections[i].T_scene_model.matrix());
      }
    }
  }
}

TEST_F(Recognize, AddsDoubtfulDetectionsWhereTheyAreAskedFor) {
  const Cloud scene = clutter();
  const auto all = recognize(recognizer_, scene, {}, {.min_score = 0});
  ASSERT_TRUE(all);
  ASSERT_GE(all->detections.size(), 2U);
  const float best = all->detections[0].score, second = all->detections[1].score;
  const auto sure = recognize(recognizer_, scene, {}, {.min_score = best});
  const auto more =
      recognize(recognizer_, scene, {}, {.min_score = best, .doubtful_score = second});
  ASSERT_TRUE(sure && more);
  EXPECT_EQ(sure->detections.size(), 1U);
  ASSERT_EQ(more->detections.size(), 2U);
  EXPECT_EQ(more->detections[1].score, second);
}

TEST_F(Recognize, TellsWhatItRejectedWhereItIsAsked) {
  const auto silent = recognize(recognizer_, clutter(), {}, {});
  const auto result = recognize(recognizer_, clutter(), {}, {.max_rejected = 3});
  ASSERT_TRUE(silent && result);
  EXPECT_TRUE(silent->rejected.empty());
  ASSERT_EQ(result->detections.size(), silent->detections.size());
  for (std::size_t i = 0; i < silent->detections.size(); ++i)
    EXPECT_EQ(result->detections[i].score, silent->detections[i].score);
  ASSERT_FALSE(result->rejected.empty());
  std::map<std::string, int> of_model;
  for (const RejectedPose& rejected : result->rejected) {
    EXPECT_LE(++of_model[rejected.model], 3);
    if (const Detection* const found = find(*result, rejected.model)) {
      const auto apart = kernels::pose_distance(rejected.T_scene_model, found->T_scene_model, {},
                                                Eigen::Vector3f::Zero());
      EXPECT_TRUE(apart.translation > 0.01F || apart.rotation_rad > 0.2F) << "the same place again";
    }
    EXPECT_EQ(rejected.reason == Rejection::too_low, rejected.score < 0.5F);
    if (rejected.score > 0) {  // else the sensor looked through too much of it
      EXPECT_EQ(rejected.score, kernels::pose_probability(recognizer_.score(), rejected.parts));
    }
    if (rejected.explained_by) {
      EXPECT_LT(*rejected.explained_by, result->detections.size());
      EXPECT_GT(rejected.explained_share, 0);
    }
  }
}

// With a limit of one instance the second one is what was rejected, in the file's unit.
TEST_F(Recognize, TellsTheInstanceThatIsOneTooMany) {
  const Pose left = test::pose_of({0.3F, 2.0F, 0.1F}, {-180, 0, 900});
  const Pose right = test::pose_of({-1.0F, 0.2F, 1.2F}, {180, 20, 950});
  test::Shape large = bracket_;
  for (const std::span<float> column :
       {large.vertices.span().x, large.vertices.span().y, large.vertices.span().z}) {
    for (float& value : column) value *= 1000;
  }
  const Cloud scene = test::render_scan({{&large, left}, {&large, right}});
  const auto result = recognize(recognizer_, scene, {.scale = 0.001},
                                {.max_instances = 1, .max_rejected = 1, .models = {"bracket"}});
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_EQ(result->detections.size(), 1U);
  ASSERT_EQ(result->rejected.size(), 1U);
  EXPECT_EQ(result->rejected[0].reason, Rejection::too_many);
  const float x = result->detections[0].T_scene_model.translation().x();
  EXPECT_NEAR(result->rejected[0].T_scene_model.translation().x(), -x, 3);
}

TEST_F(Recognize, FindsNothingInAnEmptyRoomOrInNoise) {
  const test::Shape room = test::box({-1, -1, 1.2F}, {1, 1, 1.3F});
  const auto wall = recognize(recognizer_, test::render_scan({{&room, Pose::Identity()}}), {}, {});
  ASSERT_TRUE(wall) << wall.error().message;
  EXPECT_TRUE(wall->detections.empty());

  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    test::Random random(seed);
    Cloud noise;
    for (int i = 0; i < 20000; ++i) {
      noise.points.push_back(
          {random.uniform(-0.4F, 0.4F), random.uniform(-0.4F, 0.4F), random.uniform(0.8F, 1.2F)});
    }
    const auto result = recognize(recognizer_, noise, {}, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_TRUE(result->detections.empty()) << "seed " << seed;
  }
}

TEST_F(Recognize, FindsNothingAmongUnknownObjects) {
  const test::Shape room = test::box({-1, -1, 1.2F}, {1, 1, 1.3F});
  const test::Shape block = test::box({-0.06F, -0.05F, -0.03F}, {0.06F, 0.05F, 0.03F});
  const test::Shape rod = test::prism(40, test::circle(0.03), -0.1, 0.1);
  const test::Shape hexagon = test::prism(6, test::circle(0.06), -0.02, 0.02);
  const auto result = recognize(
      recognizer_,
      test::render_scan({{&room, Pose::Identity()},
                         {&block, test::pose_of({0.4F, 0.9F, 0.2F}, {-0.1F, 0.02F, 0.9F})},
                         {&rod, test::pose_of({1.2F, 0.3F, 0.1F}, {0.1F, 0, 0.95F})},
                         {&hexagon, test::pose_of({-0.6F, 0.4F, 0}, {0.02F, -0.12F, 0.9F})}}),
      {}, {});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_TRUE(result->detections.empty());
}

TEST_F(Recognize, FindsNothingWhereNothingWasMeasured) {
  Cloud few;
  for (const int n : {0, 1, 10}) {
    while (few.points.size() < static_cast<std::size_t>(n))
      few.points.push_back({static_cast<float>(few.points.size()), 0, 1});
    const auto result = recognize(recognizer_, few, {}, {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_TRUE(result->detections.empty());
    EXPECT_EQ(result->stats.num_points, static_cast<std::size_t>(n));
  }
}

/// The scan without the columns of pixels right of that one up to which a share of it was measured.
Cloud left_part(const Cloud& scan, double share) {
  const PixelGrid& grid = *scan.grid;
  const auto wanted = static_cast<std::size_t>(share * static_cast<double>(scan.points.size()));
  std::size_t measured = 0;
  std::uint32_t end = 0;
  for (; measured < wanted; ++end) {
    for (std::uint32_t v = 0; v < grid.height; ++v)
      measured += grid.point_index[v * grid.width + end] >= 0;
  }
  Cloud out;
  out.camera = scan.camera;
  out.viewpoint = scan.viewpoint;
  out.grid = PixelGrid{grid.width, grid.height, grid.point_index};
  for (std::size_t pixel = 0; pixel < grid.point_index.size(); ++pixel) {
    std::int32_t& index = out.grid->point_index[pixel];
    if (index < 0) continue;
    const Eigen::Vector3f point = scan.points[static_cast<std::size_t>(index)];
    index =
        pixel % grid.width < end ? static_cast<std::int32_t>(out.points.size()) : PixelGrid::kNone;
    if (index >= 0) out.points.push_back(point);
  }
  return out;
}

TEST_F(Recognize, ConfirmsNoPoseThatWasMostlyNotMeasured) {
  const Cloud scan = test::render_scan({{&bracket_, bracket_pose()}});
  RecognizeOptions options;
  options.pose.rounds = 0;
  options.expected = {{"bracket", bracket_pose().cast<double>()}};
  const auto more = recognize(recognizer_, left_part(scan, 0.6), {}, options);
  ASSERT_TRUE(more) << more.error().message;
  EXPECT_EQ(more->detections.size(), 1U);
  const auto less = recognize(recognizer_, left_part(scan, 0.4), {}, options);
  ASSERT_TRUE(less) << less.error().message;
  EXPECT_TRUE(less->detections.empty());
}

TEST_F(Recognize, TakesAMovedMeshAsAClosedSurface) {
  const Pose motion = test::pose_of({0.4F, -1.2F, 2.0F}, {3, -2, 5});
  const Cloud scene = test::cloud_of(test::Shape(lever_).moved(motion));
  const auto result = recognize(recognizer_, scene, {.closed_surface = true}, {});
  ASSERT_TRUE(result) << result.error().message;
  expect_pose(find(*result, "lever"), motion, 0.2F);
}

// Its border is short beside its many faces, as that of a closed surface.
TEST_F(Recognize, FindsInATriangulatedScanWhatItFindsInThePoints) {
  const Result<Surface> surface = surface_from_points(clutter(), "scan");
  ASSERT_TRUE(surface) << surface.error().message;
  Cloud mesh;
  mesh.points = surface->mesh.points;
  mesh.triangles = surface->mesh.triangles;
  const auto result = recognize(recognizer_, mesh, {}, {});
  ASSERT_TRUE(result) << result.error().message;
  expect_pose(find(*result, "bracket"), bracket_pose(), 0.2F);
  expect_pose(find(*result, "lever"), lever_pose(), 0.2F);
  EXPECT_EQ(name_of(result->stats.view->source), "faces");
}

TEST_F(Recognize, SearchesWithinTheLimitsOnly) {
  const auto in_box = [](const Eigen::Vector3f& middle) {
    RecognizeOptions options;
    options.pose.rounds = 1;
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(0.1F);
    options.limits.region =
        PoseLimits::Region{(middle - reach).cast<double>(), (middle + reach).cast<double>()};
    return options;
  };
  const auto all = recognize(recognizer_, clutter(), {}, {.pose = {.rounds = 1}});
  const Eigen::Vector3f center = bracket_pose() * recognizer_.library().models[0].center;
  const auto near_bracket = recognize(recognizer_, clutter(), {}, in_box(center));
  ASSERT_TRUE(all && near_bracket);
  EXPECT_NE(find(*near_bracket, "bracket"), nullptr);
  EXPECT_EQ(find(*near_bracket, "lever"), nullptr) << "its center is 0.14 away";
  const auto aside = recognize(recognizer_, clutter(), {}, in_box({0.5F, 0.5F, 1}));
  ASSERT_TRUE(aside);
  EXPECT_TRUE(aside->detections.empty());
  EXPECT_LT(aside->stats.num_votes, all->stats.num_votes) << "the rest is not searched";
}

TEST_F(Recognize, TestsExpectedPosesWithoutVoting) {
  RecognizeOptions options;
  options.pose.rounds = 0;
  Pose off = lever_pose();
  off.translation() += Eigen::Vector3f(0.003F, -0.002F, 0.004F);
  options.expected = {{"lever", off.cast<double>()},
                      {"bracket", test::pose_of({1, 1, 1}, {0, 0, 0.9F}).cast<double>()}};
  const auto result = recognize(recognizer_, clutter(), {}, options);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->stats.num_votes, 0U);
  ASSERT_EQ(result->detections.size(), 1U) << "no bracket is where one was expected";
  expect_pose(find(*result, "lever"), lever_pose(), 0.2F);

  options.pose.rounds = 1;
  const auto both = recognize(recognizer_, clutter(), {}, options);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->detections.size(), 2U) << "voting finds what was not expected";
}

/// Points alone, as of a scan whose coordinates are far from zero.
TEST_F(Recognize, SpeaksOfTheFilesFrameFarFromZero) {
  Cloud near;
  near.points = clutter().points;
  Cloud far = near;
  far.offset = {512345, 5403210, 400};
  const auto expected = recognize(recognizer_, near, {.viewpoint = Eigen::Vector3d(0, 0, 0)}, {});
  const auto found = recognize(recognizer_, far, {.viewpoint = far.offset}, {});
  ASSERT_TRUE(expected && found) << found.error().message;
  ASSERT_EQ(found->detections.size(), 2U);
  EXPECT_EQ(found->offset, far.offset);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found->detections[i].T_scene_model.matrix(),
              expected->detections[i].T_scene_model.matrix());
  }

  RecognizeOptions options;
  options.pose.rounds = 0;
  options.expected = {{"bracket", in_file_frame(bracket_pose(), far.offset)},
                      {"lever", in_file_frame(lever_pose(), far.offset)}};
  const Eigen::Vector3d middle = in_file_frame(bracket_pose(), far.offset) *
                                 recognizer_.library().models[0].center.cast<double>();
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(0.1);
  options.limits.region = PoseLimits::Region{middle - reach, middle + reach};
  const auto limited = recognize(recognizer_, far, {.viewpoint = far.offset}, options);
  ASSERT_TRUE(limited) << limited.error().message;
  ASSERT_EQ(limited->detections.size(), 1U);
  expect_pose(find(*limited, "bracket"), bracket_pose(), 0.2F);

  const auto blind = recognize(recognizer_, far, {}, {});
  ASSERT_FALSE(blind) << "from the file's origin, floats cannot tell the points apart";
  EXPECT_NE(blind.error().message.find("--viewpoint"), std::string::npos);
  Cloud placed = far;
  placed.viewpoint = Eigen::Vector3f(0, 0, 0);
  EXPECT_TRUE(recognize(recognizer_, placed, {}, {})) << "where the cloud knows its sensor";
}

TEST_F(Recognize, ConvertsTheScenesUnit) {
  const Cloud scene = in_millimeters(clutter());
  const auto refused = recognize(recognizer_, scene, {}, {});
  ASSERT_FALSE(refused) << "a scene in mm against a library in m";
  EXPECT_EQ(refused.error().code, ErrorCode::bad_data);
  EXPECT_NE(refused.error().message.find("--unit"), std::string::npos);

  const auto converted = recognize(recognizer_, scene, {.scale = 0.001}, {});
  ASSERT_TRUE(converted);
  const Detection* const bracket = find(*converted, "bracket");
  ASSERT_NE(bracket, nullptr);
  EXPECT_NEAR(bracket->T_scene_model.translation().z(), 850, 3) << "poses are in the scene's unit";
}

TEST_F(Recognize, RefusesUnusableScenesAndOptions) {
  const auto unknown = recognize(recognizer_, clutter(), {}, {.models = {"spoon"}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::usage);
  EXPECT_NE(unknown.error().message.find("spoon"), std::string::npos);

  const auto wrong = recognize(recognizer_, clutter(), {}, {.min_score = std::nanf("")});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::usage);
  EXPECT_FALSE(validate(RecognizeOptions{.doubtful_score = 0.5F, .tell_claims = true}));

  for (const float window : {0.9F, 20.1F, std::nanf("")}) {
    const Result<void> valid = validate(RecognizeOptions{.normal_window = window});
    ASSERT_FALSE(valid);
    EXPECT_NE(valid.error().message.find("normal-window: expected 1 to 20 [spacing]"),
              std::string::npos)
        << valid.error().message;
  }
}

TEST_F(Recognize, SurvivesDegenerateScenes) {
  for (const auto& make : std::vector<std::function<Eigen::Vector3f(int)>>{
           [](int) { return Eigen::Vector3f(0.1F, 0.1F, 1); },  // one place
           [](int i) { return Eigen::Vector3f(0.001F * static_cast<float>(i), 0, 1); },  // a line
           [](int) { return Eigen::Vector3f(0, 0, 0); },  // the viewpoint itself
           [](int i) {
             return Eigen::Vector3f(0, 0, 0.01F * static_cast<float>(i));
           }}) {  // one ray
    Cloud cloud;
    for (int i = 0; i < 500; ++i) cloud.points.push_back(make(i));
    const auto result = recognize(recognizer_, cloud, {}, {});
    if (result) {
      EXPECT_TRUE(result->detections.empty());
    }
  }
}

TEST_F(Recognize, StopsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  const auto result = recognize(recognizer_, clutter(), {}, {}, stop.get_token());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resumable);
}

TEST_F(Recognize, TakesManyScenesInOrder) {
  const test::TempDir folder;
  std::vector<SceneInput> inputs;
  for (int i = 0; i < 4; ++i) {
    const Pose motion =
        test::pose_of({0.2F * static_cast<float>(i), 1, 0}, {static_cast<float>(i), 0, 0});
    const auto file = folder / ("scene" + std::to_string(i) + ".ply");
    ASSERT_TRUE(write_ply(file, test::cloud_of(test::Shape(bracket_).moved(motion))));
    inputs.push_back({.file = file, .closed_surface = true});
  }
  std::vector<std::size_t> order;
  const auto done =
      recognize_all(recognizer_, inputs, {}, {}, [&](std::size_t index, const SceneResult& result) {
        order.push_back(index);
        EXPECT_NE(find(result, "bracket"), nullptr) << index;
      });
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3}));

  inputs[2].file = folder / "absent.ply";
  const auto failed =
      recognize_all(recognizer_, inputs, {}, {}, [](std::size_t, const SceneResult&) {});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::missing_input);
}

}  // namespace
}  // namespace trivet
