#include "kernels/scans/fit_ray_lattice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <set>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

constexpr std::size_t kNumColumns = 80, kNumRows = 60;
constexpr float kFocalX = 70, kFocalY = 75, kCenterX = 39.5F, kCenterY = 30.25F;

/// The measured pixels of a wavy wall, seen from the origin along z.
///
/// kept   share of the pixels
/// noise  standard deviation of the pixel positions [pixel]
Points list_of_pixels(Random& random, float kept = 0.8F, float noise = 0) {
  Points points;
  for (std::size_t pixel = 0; pixel < kNumColumns * kNumRows; ++pixel) {
    if (random.uniform(0, 1) > kept) continue;
    const auto u = static_cast<float>(pixel % kNumColumns),
               v = static_cast<float>(pixel / kNumColumns);
    const float z = 2 + 0.5F * std::sin(u / 9) * std::cos(v / 7);
    points.push_back({(u + random.normal(noise) - kCenterX) / kFocalX * z,
                      (v + random.normal(noise) - kCenterY) / kFocalY * z, z});
  }
  return points;
}

Points moved(const Points& points, const Pose& motion) {
  Points out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back(motion * points[i]);
  return out;
}

/// Expects each point in the middle of a pixel of its own.
void expect_own_pixels(const ImageGeometry& geometry, const Points& points) {
  std::set<std::int64_t> pixels;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3f p = geometry.T_camera_scene * points[i];
    const std::int64_t pixel = geometry.pixel_of(p);
    ASSERT_GE(pixel, 0);
    EXPECT_LT((geometry.back_project(static_cast<std::size_t>(pixel), p.z()) - p).norm(),
              2e-3F * p.z() / geometry.fx);
    pixels.insert(pixel);
  }
  EXPECT_EQ(pixels.size(), points.size());
}

TEST(FitRayLattice, RecoversThePixelsOfAList) {
  Random random;
  const Points points = list_of_pixels(random);
  const auto camera = fit_ray_lattice(points, Vector3f::Zero());
  ASSERT_TRUE(camera);
  EXPECT_NEAR(camera->geometry.fx, kFocalX, 1e-3F);
  EXPECT_NEAR(camera->geometry.fy, kFocalY, 1e-3F);
  EXPECT_EQ(camera->geometry.width, kNumColumns);
  EXPECT_EQ(camera->geometry.height, kNumRows);
  EXPECT_NEAR(camera->geometry.cx, kCenterX, 1e-3F);
  EXPECT_NEAR(camera->geometry.cy, kCenterY, 1e-3F);
  EXPECT_LT(camera->residual, 1e-3);
  expect_own_pixels(camera->geometry, points);
}

TEST(FitRayLattice, FindsTheAxisOfEachFrame) {
  Random random;
  const Points points = list_of_pixels(random);
  Eigen::Matrix3f opengl, ros;
  opengl << 1, 0, 0, 0, -1, 0, 0, 0, -1;  // x right, y up, z back
  ros << 0, 0, 1, -1, 0, 0, 0, -1, 0;     // x forward, y left, z up
  for (const Eigen::Matrix3f& R : {opengl, ros}) {
    Pose motion = Pose::Identity();
    motion.linear() = R;
    motion.translation() = Vector3f(0.4F, -1.5F, 3);
    const Points there = moved(points, motion);
    const auto camera = fit_ray_lattice(there, motion.translation());
    ASSERT_TRUE(camera);
    EXPECT_EQ(camera->center.cast<float>(), motion.translation());
    expect_own_pixels(camera->geometry, there);
  }
}

TEST(FitRayLattice, IsTheSameForAnyOrderOfThePointsAndForRepeatedOnes) {
  Random random;
  const Points points = list_of_pixels(random);
  Points other;
  for (std::size_t i = points.size(); i-- > 0;) {
    other.push_back(points[i]);
    other.push_back(points[i]);
  }
  const auto camera = fit_ray_lattice(points, Vector3f::Zero()),
             again = fit_ray_lattice(other, Vector3f::Zero());
  ASSERT_TRUE(camera && again);
  EXPECT_EQ(camera->geometry.width, again->geometry.width);
  EXPECT_EQ(camera->geometry.height, again->geometry.height);
  EXPECT_NEAR(camera->geometry.fx, again->geometry.fx, 1e-3F);
  EXPECT_NEAR(camera->geometry.cx, again->geometry.cx, 1e-3F);
}

// A sample of the points determines the lines.
TEST(FitRayLattice, RecoversALargeImage) {
  Points points;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      const float z = 1 + 0.2F * std::sin(static_cast<float>(u) / 50);
      points.push_back({(static_cast<float>(u) - 319.5F) / 572 * z,
                        (static_cast<float>(v) - 239.5F) / 572 * z, z});
    }
  }
  const auto camera = fit_ray_lattice(points, Vector3f::Zero());
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->geometry.width, 640U);
  EXPECT_EQ(camera->geometry.height, 480U);
  EXPECT_NEAR(camera->geometry.fx, 572, 0.01F);
}

TEST(FitRayLattice, BearsRoundedCoordinates) {
  Random random;
  Points points = list_of_pixels(random);
  for (std::size_t i = 0; i < points.size(); ++i)
    points.set(i, (points[i] * 1000).array().round() / 1000);  // a pixel is 0.028 wide
  EXPECT_TRUE(fit_ray_lattice(points, Vector3f::Zero()));
}

TEST(FitRayLattice, FindsNoneWhereThePointsAreNotThoseOfAnImage) {
  Random random;
  const Vector3f origin = Vector3f::Zero();
  EXPECT_FALSE(fit_ray_lattice(list_of_pixels(random, 0.8F, 0.2F), origin)) << "beside the rays";
  EXPECT_FALSE(fit_ray_lattice(list_of_pixels(random, 0.3F), origin)) << "most pixels are missing";
  EXPECT_FALSE(fit_ray_lattice(list_of_pixels(random), {0.3F, 0, 0})) << "seen from elsewhere";
  Points scattered, few;
  for (int i = 0; i < 5000; ++i)
    scattered.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(2, 3)});
  EXPECT_FALSE(fit_ray_lattice(scattered, origin));
  for (int i = 0; i < 99; ++i)
    few.push_back({static_cast<float>(i % 10), static_cast<float>(i / 10), 10});
  EXPECT_FALSE(fit_ray_lattice(few, origin));
  EXPECT_FALSE(fit_ray_lattice(Points(1000), origin)) << "all in one place";
}

// Two patches of an image of 100 million pixels.
TEST(FitRayLattice, NeedsMemoryByItsPointsOnly) {
  Points points;
  for (int i = 0; i < 800; ++i) {
    const float at = i < 400 ? 0.0F : 1.0F;
    points.push_back(
        {at + static_cast<float>(i % 20) * 1e-4F, at + static_cast<float>(i / 20 % 20) * 1e-4F, 1});
  }
  EXPECT_FALSE(fit_ray_lattice(points, Vector3f::Zero()));
}

}  // namespace
}  // namespace trivet::kernels
