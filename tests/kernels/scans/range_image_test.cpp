#include "kernels/scans/range_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "kernels/scans/merge_pixels.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

TEST(ImageGeometry, PutsAPointInThePixelWhoseCenterIsNearest) {
  Random random;
  ImageGeometry g{Pose::Identity(), 70, 75, 39.5F, 30.25F, 80, 60};
  for (std::size_t pixel = 0; pixel < 80 * 60; ++pixel) {
    const Vector3f p = g.back_project(pixel, random.uniform(0.1F, 10));
    EXPECT_EQ(g.pixel_of(p), static_cast<std::int64_t>(pixel));
    const Vector3f shift(random.uniform(-0.49F, 0.49F) / g.fx, random.uniform(-0.49F, 0.49F) / g.fy,
                         0);
    EXPECT_EQ(g.pixel_of(p + p.z() * shift), static_cast<std::int64_t>(pixel));
  }
  for (const Vector3f& p : {Vector3f(0, 0, 0), Vector3f(0, 0, -1), Vector3f(-0.58F, 0, 1),
                            Vector3f(0.58F, 0, 1), Vector3f(0, -0.42F, 1), Vector3f(0, 0.4F, 1),
                            Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()).eval()}) {
    EXPECT_EQ(g.pixel_of(p), -1) << p.transpose();
  }
}

TEST(ChooseCamera, LeavesTwoPointsAPixelAndFewHoles) {
  for (std::uint64_t trial = 0; trial < 4; ++trial) {
    Random random(trial);
    const Pose T = random.motion();
    const Vector3f viewpoint = T * Vector3f(0, 0, 4);
    const Points points = test::transformed(random.surface(20'000), T.linear(), T.translation());
    const auto camera = choose_camera(points, viewpoint);
    ASSERT_TRUE(camera);
    EXPECT_LT((camera->T_camera_scene * viewpoint).norm(), 1e-5);
    EXPECT_NEAR(camera->T_camera_scene.linear().determinant(), 1, 1e-5);
    std::map<std::int64_t, int> points_of_pixel;
    for (std::size_t i = 0; i < points.size(); ++i) {
      ++points_of_pixel[camera->pixel_of(camera->T_camera_scene * points[i])];
    }
    EXPECT_EQ(points_of_pixel.count(-1), 0U) << "all inside";
    const auto occupied = static_cast<double>(points_of_pixel.size());
    EXPECT_NEAR(20'000 / occupied, 2, 0.15);

    // With 1.6 random points per pixel, exp(-1.6) are empty, a fifth; the empty pixels must be
    // isolated.
    const PixelGrid grid = merge_pixels(*camera, points).grid;
    Column<float> depth(grid.point_index.size(), 0);
    std::size_t inner = 0, empty = 0;
    for (std::size_t pixel = 0; pixel < depth.size(); ++pixel) {
      if (grid.point_index[pixel] != PixelGrid::kNone) depth[pixel] = 4;
    }
    fill_small_holes(*camera, 1, 4, depth);
    for (std::uint32_t v = camera->height / 3; v < camera->height * 2 / 3; ++v) {
      for (std::uint32_t u = camera->width / 3; u < camera->width * 2 / 3; ++u) {
        ++inner;
        empty += depth[v * camera->width + u] == 0;
      }
    }
    EXPECT_LT(static_cast<double>(empty), 0.01 * static_cast<double>(inner));
  }
}

TEST(ChooseCamera, CountsPointsInOnePlaceOnce) {
  Random random;
  const Points points = random.surface(20'000);
  const auto once = choose_camera(points, {0, 0, 4});
  ASSERT_TRUE(once);
  for (const float jitter : {0.0F, 1e-6F}) {
    for (const int copies : {2, 3, 7}) {
      Points many;
      for (int k = 0; k < copies; ++k) {
        for (std::size_t i = 0; i < points.size(); ++i)
          many.push_back(points[i] + Vector3f(0, jitter * static_cast<float>(k), 0));
      }
      const auto camera = choose_camera(many, {0, 0, 4});
      ASSERT_TRUE(camera);
      EXPECT_NEAR(camera->fx, once->fx, (jitter > 0 ? 0.25F : 0.001F) * once->fx)
          << copies << " copies, " << jitter << " apart";
    }
  }
}

TEST(ChooseCamera, DistinguishesNoDirectionsThatFloatsDoNot) {
  Points line;  // of sight, up to rounding
  for (int i = 0; i < 1000; ++i)
    line.push_back(Vector3f(0.1F, 0.2F, 0.7F) * (1 + 0.001F * static_cast<float>(i)));
  if (const auto camera = choose_camera(line, {0, 0, 0}); camera) {
    EXPECT_LE(camera->fx, kLargestFocalLength);
  }
  PixelGrid grid{100, 100, Column<std::int32_t>(10'000)};
  Points narrow(10'000);
  for (std::int32_t i = 0; i < 10'000; ++i) {
    grid.point_index[static_cast<std::size_t>(i)] = i;
    narrow.set(static_cast<std::size_t>(i),
               {1e-8F * static_cast<float>(i % 100), 1e-8F * static_cast<float>(i / 100), 1});
  }
  EXPECT_FALSE(fit_camera(grid, narrow)) << "a focal length of 1e8 pixels";
}

TEST(ChooseCamera, UsesTheGivenPixelUnlessTheImageGrowsTooLarge) {
  Random random;
  const Points points = random.surface(20'000);
  const auto coarse = choose_camera(points, {0, 0, 4}, 0.1F);
  ASSERT_TRUE(coarse);
  EXPECT_NEAR(4 / coarse->fx, 0.1, 0.005);  // at the center, 4 away
  EXPECT_NEAR(coarse->width, 22, 3);
  const auto fine = choose_camera(points, {0, 0, 4}, 1e-6F);
  ASSERT_TRUE(fine);
  EXPECT_LE(std::max(fine->width, fine->height), 2048U);
  EXPECT_GT(std::max(fine->width, fine->height), 2000U);
}

TEST(ChooseCamera, NeedsThreePointsAndAViewFromOutside) {
  Random random;
  const Points two = random.surface(2), three = random.surface(3);
  EXPECT_FALSE(choose_camera(two, {0, 0, 4}));
  EXPECT_TRUE(choose_camera(three, {0, 0, 4}));
  Points ring;
  for (const float x : {-1.0F, 1.0F}) {
    for (const float y : {-1.0F, 1.0F}) ring.push_back({x, y, 0});
  }
  EXPECT_FALSE(choose_camera(ring, {0, 0, 0})) << "it would not know where to look";
  Points same;
  for (int i = 0; i < 5; ++i) same.push_back({1, 1, 1});
  EXPECT_FALSE(choose_camera(same, {0, 0, 0})) << "no extent";
}

struct Patch {
  ImageGeometry geometry{Pose::Identity(), 10, 10, 4, 4, 5, 5};
  Column<float> depth = Column<float>(25, 2);
};

TEST(FillSmallHoles, GivesTheMeanOfLikeNeighbors) {
  Patch patch;
  patch.depth[12] = 0;
  patch.depth[6] = 2.25F;
  patch.depth[7] = 0;  // borders another hole: both are filled from measurements
  EXPECT_EQ(fill_small_holes(patch.geometry, 0.25F, 4, patch.depth), 2U);
  EXPECT_EQ(patch.depth[12], (6 * 2 + 2.25F) / 7);
  EXPECT_EQ(patch.depth[7], (6 * 2 + 2.25F) / 7);
}

TEST(FillSmallHoles, LeavesEdgesGapsAndBordersAlone) {
  Patch step;  // a neighbor on another surface
  step.depth[12] = 0;
  step.depth[6] = 2.5F;
  EXPECT_EQ(fill_small_holes(step.geometry, 0.25F, 4, step.depth), 0U);
  EXPECT_EQ(step.depth[12], 0);

  Patch gap;  // too few neighbors
  for (const std::size_t pixel : {6U, 7U, 8U, 11U, 12U}) gap.depth[pixel] = 0;
  EXPECT_EQ(fill_small_holes(gap.geometry, 0.25F, 5, gap.depth), 3U);
  EXPECT_EQ(gap.depth[7], 0) << "four neighbors";
  EXPECT_EQ(gap.depth[12], 0) << "four neighbors";

  Patch border;
  border.depth[2] = border.depth[10] = border.depth[24] = 0;
  EXPECT_EQ(fill_small_holes(border.geometry, 0.25F, 1, border.depth), 0U);
}

}  // namespace
}  // namespace trivet::kernels
