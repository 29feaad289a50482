#include "engine/recognition/recognize.hpp"

#include <gtest/gtest.h>

#include <map>

#include "engine/common/thread_limit.hpp"
#include "engine/recognition/two_parts.hpp"
#include "kernels/common/pose_math.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/trained_library.hpp"

namespace trivet {
namespace {

/// Which parts are found, and which are not.
class Recognize : public test::TwoParts {};

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
  // Most refined poses agree little, and lie on what those of the first portion explain.
  EXPECT_LT(result->stats.num_examined, result->stats.num_refined / 4);
  RecognizeOptions one;
  one.max_instances = 1;
  const auto limited = recognize(recognizer_, scene, {}, one);
  ASSERT_TRUE(limited);
  EXPECT_EQ(limited->detections.size(), 1U);
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
      recognize(recognizer_, scene, {}, {.min_score = best, .doubtful_score = 0.9F * second});
  ASSERT_TRUE(sure && more);
  EXPECT_EQ(sure->detections.size(), 1U);
  ASSERT_EQ(more->detections.size(), 2U);
  EXPECT_NEAR(more->detections[1].score, second, 1e-3) << "what else is there moves it a little";
}

TEST_F(Recognize, ReportsRejectedPosesOnRequest) {
  const test::Shape rod = test::prism(40, test::circle(0.03), -0.1, 0.1);
  const Cloud scene =
      test::render_scan({{&bracket_, bracket_pose()},
                         {&lever_, lever_pose()},
                         {&rod, test::pose_of({1.2F, 0.3F, 0.1F}, {-0.12F, -0.12F, 0.95F})}});
  const auto silent = recognize(recognizer_, scene, {}, {});
  const auto result = recognize(recognizer_, scene, {}, {.max_rejected = 3});
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
    if (rejected.score > 0) {  // otherwise the sensor measured through too much of it
      EXPECT_EQ(rejected.score, kernels::pose_probability(recognizer_.score(), rejected.parts));
    }
    if (rejected.explained_by) {
      EXPECT_LT(*rejected.explained_by, result->detections.size());
      EXPECT_GT(rejected.explained_share, 0);
    }
  }
}

// With a limit of one instance the second is reported as rejected, in the file's unit.
TEST_F(Recognize, ReportsTheInstanceBeyondTheLimit) {
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

/// The scan up to the column of pixels at which it contains this share of the measurements.
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

TEST_F(Recognize, ConfirmsNoPoseThatWasHardlyMeasured) {
  const Cloud scan = test::render_scan({{&bracket_, bracket_pose()}});
  RecognizeOptions options;
  options.pose.rounds = 0;
  options.expected = {{"bracket", bracket_pose().cast<double>()}};
  const auto more = recognize(recognizer_, left_part(scan, 0.6), {}, options);
  ASSERT_TRUE(more) << more.error().message;
  EXPECT_EQ(more->detections.size(), 1U);
  const auto less = recognize(recognizer_, left_part(scan, 0.15), {}, options);
  ASSERT_TRUE(less) << less.error().message;
  EXPECT_TRUE(less->detections.empty());
}

}  // namespace
}  // namespace trivet
