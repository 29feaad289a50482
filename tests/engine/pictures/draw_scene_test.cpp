#include "engine/pictures/draw_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>

#include "engine/scene/read_scene.hpp"
#include "support/shapes.hpp"

namespace trivet {
namespace {

constexpr std::uint32_t kWidth = 640, kHeight = 480;
const Camera kCamera{600, 600, 319.5, 239.5, 1};

/// A depth image of a wall 2 m away.
Cloud wall() {
  Cloud cloud;
  cloud.camera = kCamera;
  cloud.viewpoint = Eigen::Vector3f::Zero();
  cloud.grid = PixelGrid{kWidth, kHeight, {}};
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
    cloud.grid->point_index.push_back(static_cast<std::int32_t>(i));
    cloud.points.push_back(Eigen::Vector3d((i % kWidth - kCamera.cx) / kCamera.fx * 2,
                                           (i / kWidth - kCamera.cy) / kCamera.fy * 2, 2)
                               .cast<float>());
  }
  return cloud;
}

EvaluationMesh cube() {
  const test::Shape shape = test::box({-0.1F, -0.1F, -0.1F}, {0.1F, 0.1F, 0.1F});
  return {"cube", shape.vertices, shape.triangles, 0.2 * std::sqrt(3.0), {}};
}

FilePose pose_in_front(float z) {
  FilePose pose = FilePose::Identity();
  pose.translation() << 0, 0, static_cast<double>(z);
  return pose;
}

SceneInput depth_image() {
  SceneInput input;
  input.camera = kCamera;
  return input;
}

Result<ScenePictures> draw_scene(const Cloud& cloud, const SceneInput& input,
                                 std::span<const Overlay> overlays) {
  Result<SceneDrawing> drawing = SceneDrawing::prepare(cloud, input, 0.35F);
  if (!drawing) return drawing.error();
  return drawing->draw(overlays);
}

std::array<int, 3> pixel(const Picture& picture, std::uint32_t u, std::uint32_t v) {
  const std::size_t at = std::size_t{3} * (v * picture.width + u);
  return {picture.rgb[at], picture.rgb[at + 1], picture.rgb[at + 2]};
}

constexpr Color kGreen{0, 255, 0}, kOrange{255, 128, 0};

// The face of the cube at z = 0.9 spans 0.2 * 600 / 0.9 = 133 pixels.
TEST(DrawScene, PutsModelsWhereTheyAre) {
  const EvaluationMesh model = cube();
  const std::array overlays{Overlay{&model, pose_in_front(1), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), overlays);
  ASSERT_TRUE(pictures) << pictures.error().message;
  ASSERT_EQ(pictures->overlaid.width, kWidth);
  const DrawnBox& box = pictures->boxes[0];
  EXPECT_NEAR((box.right - box.left) * kWidth, 600 * 0.2 / 0.9, 2);
  EXPECT_NEAR((box.top + box.bottom) / 2, 0.5, 0.01);
  const auto [red, green, blue] = pixel(pictures->overlaid, 320, 240);
  EXPECT_GT(red, green);
  EXPECT_EQ(blue, 0);
  EXPECT_EQ(pixel(pictures->overlaid, 254, 240), (std::array{0, 255, 0}))
      << "the left edge is outlined";
  EXPECT_EQ(pixel(pictures->overlaid, 100, 240), pixel(pictures->scan, 100, 240))
      << "the rest is the scan";
}

TEST(DrawScene, DrawsWhatIsHiddenPalerAndWhatIsNotFilledAsAnOutline) {
  const EvaluationMesh model = cube();
  const std::array behind{Overlay{&model, pose_in_front(4), kGreen, kOrange, true}};
  const std::array outline{Overlay{&model, pose_in_front(1), kGreen, kOrange, false}};
  const Result<ScenePictures> hidden = draw_scene(wall(), depth_image(), behind);
  const Result<ScenePictures> outlined = draw_scene(wall(), depth_image(), outline);
  ASSERT_TRUE(hidden && outlined);
  const auto [red, green, blue] = pixel(hidden->overlaid, 320, 240);
  EXPECT_GT(red, blue);
  EXPECT_GT(blue, 0) << "the wall shows through";
  EXPECT_EQ(pixel(outlined->overlaid, 320, 240), pixel(outlined->scan, 320, 240));
  EXPECT_EQ(pixel(outlined->overlaid, 254, 240), (std::array{0, 255, 0}));
}

// A nearer cube hides the center and the right of the farther cube's box.
TEST(DrawScene, PutsLabelsOnVisibleParts) {
  const EvaluationMesh model = cube();
  FilePose near = pose_in_front(0.8F), far = pose_in_front(1);
  near.translation().x() = 0.05F;
  const std::array overlays{Overlay{&model, far, kGreen, kOrange, true},
                            Overlay{&model, near, kGreen, kOrange, true},
                            Overlay{&model, pose_in_front(4), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), overlays);
  ASSERT_TRUE(pictures) << pictures.error().message;
  const DrawnBox &behind = pictures->boxes[0], &before = pictures->boxes[1];
  EXPECT_LT(behind.label_x, before.left);
  EXPECT_GT(behind.label_x, behind.left);
  EXPECT_NEAR(before.label_x, (before.left + before.right) / 2, 0.02);
  EXPECT_NEAR(before.label_y, (before.top + before.bottom) / 2, 0.02);
}

// A cube behind the wall is invisible: its label is at the center of its drawn outline.
TEST(DrawScene, PutsLabelsOfHiddenModelsIntoTheirMiddle) {
  const EvaluationMesh model = cube();
  const std::array overlays{Overlay{&model, pose_in_front(4), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), overlays);
  ASSERT_TRUE(pictures) << pictures.error().message;
  EXPECT_NEAR(pictures->boxes[0].label_x, 0.5, 0.01);
  EXPECT_NEAR(pictures->boxes[0].label_y, 0.5, 0.01);
}

TEST(DrawScene, LeavesModelsOutsideTheImageOut) {
  const EvaluationMesh model = cube();
  const std::array overlays{Overlay{&model, pose_in_front(-3), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), overlays);
  ASSERT_TRUE(pictures);
  EXPECT_GT(pictures->boxes[0].left, pictures->boxes[0].right);
  EXPECT_EQ(pictures->overlaid.rgb, pictures->scan.rgb);
}

TEST(DrawScene, AcceptsPosesInTheScenesUnit) {
  const EvaluationMesh model = cube();
  Cloud millimeters = wall();
  for (const std::span<float> column :
       {millimeters.points.span().x, millimeters.points.span().y, millimeters.points.span().z}) {
    for (float& value : column) value *= 1000;
  }
  SceneInput input = depth_image();
  input.scale = 0.001;
  const std::array overlays{Overlay{&model, pose_in_front(1000), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(millimeters, input, overlays);
  ASSERT_TRUE(pictures) << pictures.error().message;
  EXPECT_NEAR((pictures->boxes[0].right - pictures->boxes[0].left) * kWidth, 600 * 0.2 / 0.9, 2);
}

// The cube spans 600 * 0.2 / 0.9 = 133 pixels of the scan; the detail is 1.6 times as wide.
TEST(DrawScene, ShowsASquareAroundWhatItIsAskedFor) {
  const EvaluationMesh model = cube();
  Result<SceneDrawing> drawing = SceneDrawing::prepare(wall(), depth_image(), 0.35F);
  ASSERT_TRUE(drawing) << drawing.error().message;
  const std::array overlays{Overlay{&model, pose_in_front(1), kGreen, kOrange, false}};
  const Result<ScenePictures> detail = drawing->draw_around(overlays, overlays);
  ASSERT_TRUE(detail) << detail.error().message;
  EXPECT_EQ(detail->scan.width, detail->scan.height);
  EXPECT_GE(detail->scan.width, 360U);
  EXPECT_LE(detail->scan.width, 720U);
  const DrawnBox& box = detail->boxes[0];
  EXPECT_NEAR(box.right - box.left, 1 / 1.6, 0.02);
  EXPECT_NEAR((box.left + box.right) / 2, 0.5, 0.01);
  EXPECT_NEAR((box.top + box.bottom) / 2, 0.5, 0.01);
}

TEST(DrawScene, ShowsWhatReachesOutOfTheImage) {
  const EvaluationMesh model = cube();
  Result<SceneDrawing> drawing = SceneDrawing::prepare(wall(), depth_image(), 0.35F);
  ASSERT_TRUE(drawing);
  FilePose corner = pose_in_front(1);
  corner.translation().x() = -0.53;
  const std::array overlays{Overlay{&model, corner, kGreen, kOrange, false}};
  const Result<ScenePictures> detail = drawing->draw_around(overlays, overlays);
  ASSERT_TRUE(detail) << detail.error().message;
  EXPECT_LT(pixel(detail->scan, 2, 2)[0], 40) << "nothing was measured there";
  EXPECT_GT(pixel(detail->scan, detail->scan.width - 3, detail->scan.height / 2)[0], 60);

  const std::array behind{Overlay{&model, pose_in_front(-3), kGreen, kOrange, false}};
  EXPECT_FALSE(drawing->draw_around(behind, behind));
}

TEST(DrawScene, DrawsEachOutlineCompletely) {
  const EvaluationMesh model = cube();
  constexpr Color kBlue{0, 0, 255};
  const std::array both{Overlay{&model, pose_in_front(1), kBlue, {}, false},
                        Overlay{&model, pose_in_front(1.0001F), kGreen, {}, false}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), both);
  ASSERT_TRUE(pictures);
  for (std::uint32_t v = 180; v < 300; ++v)
    EXPECT_EQ(pixel(pictures->overlaid, 254, v), (std::array{0, 255, 0})) << "the last lies on top";
}

TEST(DrawScene, DrawsCloudsAsSpheres) {
  EvaluationMesh model = cube();
  model.triangles = Triangles();
  Points vertices;
  for (int i = 0; i < 400; ++i) {
    vertices.push_back({0.01F * static_cast<float>(i % 20) - 0.095F,
                        0.01F * static_cast<float>(i / 20) - 0.095F, 0});
  }
  model.vertices = std::move(vertices);
  const std::array overlays{Overlay{&model, pose_in_front(1), kGreen, kOrange, true}};
  const Result<ScenePictures> pictures = draw_scene(wall(), depth_image(), overlays);
  ASSERT_TRUE(pictures) << pictures.error().message;
  EXPECT_EQ(pixel(pictures->overlaid, 320, 240)[2], 0) << "no gaps";
}

}  // namespace
}  // namespace trivet
