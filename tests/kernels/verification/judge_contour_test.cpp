#include <gtest/gtest.h>

#include <array>

#include "kernels/verification/verify_pose.hpp"
#include "support/allocations.hpp"
#include "support/analytic_scene.hpp"

namespace trivet::kernels {
namespace {

using test::left_half;
using test::PlacedSurface;
using test::wall;

constexpr std::array<std::uint8_t, 1> kBackground{1};

/// A plate that faces the camera, its front at depth 3, in different surroundings.
struct PlateScene {
  test::Solid solid = test::box_of({0.4, 0.3, 0.05});
  test::SampledModel plate = test::sampled_solid(solid, 0.03F, 0.5F);
  Pose pose = test::placed({0, 0, 3.05F});
  PlacedSurface alone{test::moved(test::boundary(solid), pose)};
  ContourScratch scratch;

  Evidence judge(const std::vector<PlacedSurface>& surfaces, bool background = false) {
    const ImageGeometry geometry{Pose::Identity(), 200, 200, 79.5F, 59.5F, 160, 120};
    const std::array images{test::render(geometry, surfaces)};
    return judge(images, background);
  }
  Evidence judge(std::span<const RangeImage> images, bool background = false) {
    VerifyOptions options;
    options.tolerance = 0.03F;
    if (background) options.plane_is_background = kBackground;
    Evidence e;
    e.add(judge_contour(images, plate.view(), plate.view().points.size(), pose, options, scratch));
    return e;
  }
};

TEST(JudgeContour, IsFreeWhereTheSceneFallsBackOrIsNotMeasured) {
  PlateScene scene;
  for (const auto& surfaces : {std::vector{scene.alone}, std::vector{scene.alone, wall(3.4)}}) {
    const Evidence e = scene.judge(surfaces);
    EXPECT_GT(e.contour_free, 100U);  // its outline is some 90 pixels long in cells of 1.6
    EXPECT_EQ(e.contour_crossed, 0U);
    EXPECT_EQ(e.contour(), 1);
  }
}

TEST(JudgeContour, IsCrossedWhereTheSurfaceRunsOn) {
  PlateScene scene;
  const Evidence everywhere = scene.judge({wall(3, 1)});
  EXPECT_EQ(everywhere.contour_free, 0U);
  EXPECT_GT(everywhere.contour_crossed, 100U);
  EXPECT_EQ(everywhere.contour(), 0);
  const Evidence to_the_left = scene.judge({scene.alone, left_half(3.02)});
  EXPECT_NEAR(to_the_left.contour(), 0.5, 0.1);
}

TEST(JudgeContour, IsNeutralBesideBackgroundPlanesAndNearerThings) {
  PlateScene scene;
  const Evidence on_table = scene.judge({wall(3, 1)}, true);
  EXPECT_EQ(on_table.contour_free + on_table.contour_crossed, 0U);
  const Evidence hidden = scene.judge({wall(2)});
  EXPECT_EQ(hidden.contour_free + hidden.contour_crossed, 0U);
  EXPECT_EQ(hidden.contour(), 1) << "nothing to judge";
}

TEST(JudgeContour, DoesNotJudgeOutsideTheImageNorAtTheCamera) {
  PlateScene scene;
  const std::uint32_t whole = scene.judge({scene.alone}).contour_free;
  for (const auto& [x, y] : {std::pair{1.2F, 0.0F}, {-1.2F, 0.0F}, {0.0F, 0.9F}, {0.0F, -0.9F}}) {
    scene.pose = test::placed({x, y, 3.05F});  // its center is on the image's edge
    const Evidence half =
        scene.judge({PlacedSurface{test::moved(test::boundary(scene.solid), scene.pose)}});
    EXPECT_NEAR(half.contour_free, whole / 2, whole / 8) << x << ' ' << y;
    EXPECT_EQ(half.contour_crossed, 0U);
  }
  scene.pose = test::placed({0, 0, 0});
  EXPECT_EQ(scene.judge({wall(3)}).contour_free, 0U);
}

TEST(JudgeContour, AllocatesOnceForAScratch) {
  PlateScene scene;
  const ImageGeometry geometry{Pose::Identity(), 200, 200, 79.5F, 59.5F, 160, 120};
  const std::array images{test::render(geometry, {scene.alone})};
  scene.judge(images);
  EXPECT_EQ(test::allocations_in([&] { scene.judge(images); }), 0U);
}

}  // namespace
}  // namespace trivet::kernels
