#include "kernels/scans/pixel_window.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;

constexpr std::uint32_t kWidth = 64, kHeight = 48;
const Camera kCamera{60, 55, 30.5, 25.25, 1};

bool touches(std::uint32_t u, std::uint32_t v, const Vector3d& center, double radius) {
  const Vector3d ray =
      Vector3d((u - kCamera.cx) / kCamera.fx, (v - kCamera.cy) / kCamera.fy, 1).normalized();
  return (center - std::max(0.0, center.dot(ray)) * ray).norm() <= radius;
}

TEST(WindowOfBall, HoldsEveryPixelThatShowsTheBall) {
  test::Random random;
  int num_visible = 0;
  for (int round = 0; round < 300; ++round) {
    const auto z = static_cast<double>(random.uniform(-1, 4));
    const Vector3d center(static_cast<double>(random.uniform(-3, 3)),
                          static_cast<double>(random.uniform(-3, 3)), z);
    const auto radius = static_cast<double>(random.uniform(0, 1.5F));
    const PixelWindow window = window_of_ball(kCamera, kWidth, kHeight, center, radius);
    EXPECT_LE(window.left + window.width, kWidth);
    EXPECT_LE(window.top + window.height, kHeight);
    for (std::uint32_t v = 0; v < kHeight; ++v) {
      for (std::uint32_t u = 0; u < kWidth; ++u) {
        if (!touches(u, v, center, radius)) continue;
        ++num_visible;
        EXPECT_TRUE(window.contains(u, v)) << u << ' ' << v << ", round " << round;
      }
    }
  }
  EXPECT_GT(num_visible, 10000);
}

// On the axis, the tangent of the ball's outline is that of asin(r / z): 60 * tan(asin(0.1)) =
// 6.03.
TEST(WindowOfBall, IsNoWiderThanTheOutlineAndAPixelOnEitherSide) {
  const PixelWindow window = window_of_ball(kCamera, kWidth, kHeight, {0, 0, 5}, 0.5);
  EXPECT_EQ(window.left, 24U);  // ceil(30.5 - 6.03) - 1
  EXPECT_EQ(window.left + window.width - 1, 37U);
  EXPECT_EQ(window.top, 19U);  // ceil(25.25 - 5.53) - 1
  EXPECT_EQ(window.top + window.height - 1, 31U);
}

TEST(WindowOfBall, IsEmptyBehindTheCameraAndBesideTheImage) {
  EXPECT_TRUE(window_of_ball(kCamera, kWidth, kHeight, {0, 0, -1}, 0.9).empty());
  EXPECT_TRUE(window_of_ball(kCamera, kWidth, kHeight, {9, 0, 5}, 0.5).empty());
  EXPECT_TRUE(window_of_ball(kCamera, kWidth, kHeight, {0, -9, 5}, 0.5).empty());
}

TEST(WindowOfBall, IsTheFullImageForABallAroundTheCamera) {
  const PixelWindow whole{0, 0, kWidth, kHeight};
  EXPECT_EQ(window_of_ball(kCamera, kWidth, kHeight, {0, 0, 0.5}, 0.5), whole);
  EXPECT_EQ(window_of_ball(kCamera, kWidth, kHeight, {0, 0, -0.2}, 0.5), whole);
}

TEST(PixelWindow, OverlapsWhereBothHaveAPixel) {
  const PixelWindow window{10, 10, 5, 5};
  EXPECT_TRUE(window.overlaps({14, 14, 1, 1}));
  EXPECT_FALSE(window.overlaps({15, 10, 5, 5}));
  EXPECT_FALSE(window.overlaps({10, 5, 5, 5}));
  EXPECT_FALSE(window.overlaps({12, 12, 0, 3}));
}

// The pixel at (left, top) has the same ray as (0, 0) of the window's camera.
TEST(CameraOfWindow, ShiftsTheMiddle) {
  const Camera camera = camera_of_window(kCamera, {10, 20, 5, 5});
  EXPECT_EQ((0 - camera.cx) / camera.fx, (10 - kCamera.cx) / kCamera.fx);
  EXPECT_EQ((0 - camera.cy) / camera.fy, (20 - kCamera.cy) / kCamera.fy);
}

}  // namespace
}  // namespace trivet::kernels
