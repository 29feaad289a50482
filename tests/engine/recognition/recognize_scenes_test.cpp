#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <utility>

#include "engine/meshing/surface_from_points.hpp"
#include "engine/recognition/recognize.hpp"
#include "engine/recognition/two_parts.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/rendered_scene.hpp"
#include "support/smoothed_image.hpp"
#include "support/temp_dir.hpp"

namespace trivet {
namespace {

/// Scenes of all kinds, units and frames, and the limits of the search.
class RecognizeScenes : public test::TwoParts {};

TEST_F(RecognizeScenes, TreatsAMovedMeshAsAClosedSurface) {
  const Pose motion = test::pose_of({0.4F, -1.2F, 2.0F}, {3, -2, 5});
  const Cloud scene = test::cloud_of(test::Shape(lever_).moved(motion));
  const auto result = recognize(recognizer_, scene, {.closed_surface = true}, {});
  ASSERT_TRUE(result) << result.error().message;
  expect_pose(find(*result, "lever"), motion, 0.2F);
}

// Its border is short relative to its many faces, like that of a closed surface.
TEST_F(RecognizeScenes, FindsInATriangulatedScanWhatItFindsInThePoints) {
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

TEST_F(RecognizeScenes, SearchesWithinTheLimitsOnly) {
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

/// The pixels of an organized scan in every n-th row and m-th column.
Cloud thinned(const Cloud& scan, std::size_t rows, std::size_t columns) {
  Cloud out;
  out.grid = PixelGrid{scan.grid->width, scan.grid->height, {}};
  for (std::size_t pixel = 0; pixel < scan.grid->point_index.size(); ++pixel) {
    const std::int32_t point = scan.grid->point_index[pixel];
    const bool is_kept = point != PixelGrid::kNone && pixel / scan.grid->width % rows == 0 &&
                         pixel % scan.grid->width % columns == 0;
    out.grid->point_index.push_back(is_kept ? static_cast<std::int32_t>(out.points.size())
                                            : PixelGrid::kNone);
    if (is_kept) out.points.push_back(scan.points[static_cast<std::size_t>(point)]);
  }
  return out;
}

// Pixels without measured neighbors have neither normals nor noise, and looked like gaps.
TEST_F(RecognizeScenes, TakesASparseImageForTheCloudThatItIs) {
  for (const auto& [rows, columns] : {std::pair{2, 1}, std::pair{1, 2}, std::pair{2, 2}}) {
    SCOPED_TRACE(rows + 10 * columns);
    const auto result = recognize(
        recognizer_,
        thinned(clutter(), static_cast<std::size_t>(rows), static_cast<std::size_t>(columns)), {},
        {});
    ASSERT_TRUE(result) << result.error().message;
    EXPECT_EQ(result->stats.view->kind, SceneKind::points);
    EXPECT_EQ(result->detections.size(), 2U);
    expect_pose(find(*result, "bracket"), bracket_pose(), 0.2F);
    expect_pose(find(*result, "lever"), lever_pose(), 0.2F);
  }
}

/// The same depth image after a filter has smoothed it.
Cloud smoothed(Cloud scan, double length) {
  kernels::RangeImage image;
  image.geometry.width = scan.grid->width;
  image.geometry.height = scan.grid->height;
  for (const std::int32_t point : scan.grid->point_index)
    image.depth.push_back(scan.points[static_cast<std::size_t>(point)].z());
  const kernels::RangeImage blurred = test::smoothed(image, length);
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const auto point = static_cast<std::size_t>(scan.grid->point_index[pixel]);
    scan.points.set(point, blurred.depth[pixel] / image.depth[pixel] * scan.points[point]);
  }
  return scan;
}

TEST_F(RecognizeScenes, KnowsAFilterByWhatItLeavesOfParts) {
  static const test::Shape wall = test::box({-1, -1, 1.4F}, {1, 1, 1.5F}),
                           board = test::box({-0.4F, -0.3F, 1.36F}, {0.4F, 0.3F, 1.4F});
  const Cloud sharp = test::render_scan({{&wall, Pose::Identity()},
                                         {&board, Pose::Identity()},
                                         {&bracket_, bracket_pose()},
                                         {&lever_, lever_pose()}});
  const auto plain = recognize(recognizer_, sharp, {}, {});
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->stats.sensor->smoothing, 0);

  const auto result = recognize(recognizer_, smoothed(sharp, 4), {}, {});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_GT(result->stats.sensor->smoothing, 0);
  EXPECT_EQ(result->detections.size(), 2U);
  for (const auto& [name, pose] :
       {std::pair{"bracket", bracket_pose()}, std::pair{"lever", lever_pose()}}) {
    const Detection* found = find(*result, name);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_LT((found->T_scene_model.translation() - pose.translation()).norm(), 0.005F) << name;
  }
}

TEST_F(RecognizeScenes, TestsExpectedPosesWithoutVoting) {
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

/// Points without a grid, as in a scan whose coordinates are far from zero.
TEST_F(RecognizeScenes, SpeaksOfTheFilesFrameFarFromZero) {
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
  ASSERT_FALSE(blind) << "from the file's origin, floats cannot distinguish the points";
  EXPECT_NE(blind.error().message.find("--viewpoint"), std::string::npos);
  Cloud placed = far;
  placed.viewpoint = Eigen::Vector3f(0, 0, 0);
  EXPECT_TRUE(recognize(recognizer_, placed, {}, {})) << "where the cloud knows its sensor";
}

TEST_F(RecognizeScenes, ConvertsTheScenesUnit) {
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

TEST_F(RecognizeScenes, RefusesUnusableScenesAndOptions) {
  const auto unknown = recognize(recognizer_, clutter(), {}, {.models = {"spoon"}});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::usage);
  EXPECT_NE(unknown.error().message.find("spoon"), std::string::npos);

  const auto wrong = recognize(recognizer_, clutter(), {}, {.min_score = std::nanf("")});
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().code, ErrorCode::usage);

  for (const float window : {0.9F, 20.1F, std::nanf("")}) {
    const Result<void> valid = validate(RecognizeOptions{.normal_window = window});
    ASSERT_FALSE(valid);
    EXPECT_NE(valid.error().message.find("normal-window: expected 1 to 20 [spacing]"),
              std::string::npos)
        << valid.error().message;
  }
}

TEST_F(RecognizeScenes, SurvivesDegenerateScenes) {
  for (const auto& make : std::vector<std::function<Eigen::Vector3f(int)>>{
           [](int) { return Eigen::Vector3f(0.1F, 0.1F, 1); },  // one position
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

TEST_F(RecognizeScenes, StopsOnRequest) {
  std::stop_source stop;
  stop.request_stop();
  const auto result = recognize(recognizer_, clutter(), {}, {}, stop.get_token());
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::resumable);
}

TEST_F(RecognizeScenes, RecognizesManyScenesInOrder) {
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

  std::vector<std::size_t> found, lost;
  const auto others = recognize_all(
      recognizer_, inputs, {}, {},
      [&](std::size_t index, const SceneResult&) { found.push_back(index); },
      [&](std::size_t index, const Error& error) {
        lost.push_back(index);
        EXPECT_EQ(error.code, ErrorCode::missing_input);
      });
  EXPECT_TRUE(others) << others.error().message;
  EXPECT_EQ(found, (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(lost, (std::vector<std::size_t>{2}));

  RecognizeOptions unknown;
  unknown.models = {"none of this name"};
  const auto refused = recognize_all(
      recognizer_, inputs, unknown, {}, [](std::size_t, const SceneResult&) {},
      [](std::size_t, const Error&) { FAIL() << "all scenes would be without it"; });
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::usage);
}

// Where there is no surface, a sensor gives a few pixels at the end of its numeric range.
TEST_F(RecognizeScenes, LeavesOutPointsFarBeyondAllOthers) {
  const Cloud scan = clutter();
  Cloud stray = scan;
  const std::size_t n = scan.points.size();
  for (std::size_t i = 0; i < n; i += 200)
    stray.points.set(i, 200 / scan.points[i].z() * scan.points[i]);
  const auto result = recognize(recognizer_, stray, {}, {});
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->stats.num_stray, (n + 199) / 200);
  EXPECT_EQ(result->stats.num_points, n - (n + 199) / 200);
  expect_pose(find(*result, "bracket"), bracket_pose(), 0.2F);
  expect_pose(find(*result, "lever"), lever_pose(), 0.2F);
  EXPECT_EQ(recognize(recognizer_, scan, {}, {})->stats.num_stray, 0U);

  for (std::size_t i = 0; i < n; i += 50)
    stray.points.set(i, 200 / scan.points[i].z() * scan.points[i]);
  const auto many = recognize(recognizer_, stray, {}, {});
  ASSERT_FALSE(many) << "2 % are no strays";
  EXPECT_NE(many.error().message.find("give --unit"), std::string::npos);
}

TEST_F(RecognizeScenes, RefusesAViewpointInMetersOfAScanInMillimeters) {
  Cloud cloud;
  for (int i = 0; i <= 40; ++i) {
    for (int j = 0; j <= 40; ++j) {
      const auto x = static_cast<float>(5 * i - 100), y = static_cast<float>(5 * j - 100);
      cloud.points.push_back({x, y, 10 * std::sin(x / 20)});
    }
  }
  const Eigen::Vector3d eye(0.05, -0.03, 0.6);  // [m]
  SceneInput input{.viewpoint = eye, .scale = 0.001};
  const auto refused = recognize(recognizer_, cloud, input, {});
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("as if it were in meters"), std::string::npos)
      << refused.error().message;
  input.viewpoint = 1000 * eye;
  EXPECT_TRUE(recognize(recognizer_, cloud, input, {.pose = {.rounds = 0}}));
}

}  // namespace
}  // namespace trivet
