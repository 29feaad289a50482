#include "kernels/scans/merge_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using test::Random;

/// Oriented points on surfaces some pixels apart, with some behind the camera or facing away.
struct Scattered {
  ImageGeometry geometry;
  Points points;
  Normals normals;
};

Scattered scattered(Random& random) {
  Scattered scan{{random.motion(), 20, 20, 7.5F, 7.5F, 16, 16}, {}, {}};
  for (int i = 0; i < 2000; ++i) {
    const float z = (random.below(9) == 0 ? -1.0F : 1.0F) *
                    (1 + static_cast<float>(random.below(3)) + random.normal(0.01F));
    const Vector3f ray(random.uniform(-0.6F, 0.6F), random.uniform(-0.6F, 0.6F), 1);
    scan.points.push_back(scan.geometry.T_camera_scene.inverse() * (z * ray));
    scan.normals.push_back(random.direction());
  }
  return scan;
}

/// Naive reference in double: the means of each pixel's points within the gate.
std::map<std::int64_t, Vector3d> means(const Scattered& scan, bool with_normals) {
  std::map<std::int64_t, std::vector<std::pair<double, std::size_t>>> by_pixel;
  const auto& T = scan.geometry.T_camera_scene;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vector3f p = T * scan.points[i];
    const std::int64_t pixel = scan.geometry.pixel_of(p);
    if (pixel < 0 || (with_normals && p.dot(T.linear() * scan.normals[i]) >= 0)) continue;
    by_pixel[pixel].emplace_back(p.z(), i);
  }
  std::vector<double> differences;
  for (auto& [pixel, points] : by_pixel) {
    std::ranges::sort(points);
    if (points.size() > 1) differences.push_back(points[1].first - points[0].first);
  }
  std::ranges::sort(differences);
  const double noise = differences[differences.size() / 4];
  std::map<std::int64_t, Vector3d> out;
  for (const auto& [pixel, points] : by_pixel) {
    const double nearest = points.front().first, gate = std::max(4 * nearest / 20, 12 * noise);
    Vector3d sum = Vector3d::Zero();
    double n = 0;
    for (const auto& [z, i] : points) {
      if (z > nearest + gate) continue;
      sum += scan.points[i].cast<double>();
      n += 1;
    }
    out[pixel] = sum / n;
  }
  return out;
}

TEST(MergePixels, GivesTheMeanOfEachPixelsNearestSurface) {
  Random random;
  const Scattered scan = scattered(random);
  for (const bool with_normals : {false, true}) {
    const auto expected = means(scan, with_normals);
    const MergedPixels merged = with_normals
                                    ? merge_pixels(scan.geometry, scan.points, scan.normals)
                                    : merge_pixels(scan.geometry, scan.points);
    EXPECT_EQ(merged.points.size(), expected.size());
    EXPECT_EQ(merged.normals.size(), with_normals ? expected.size() : 0U);
    ASSERT_EQ(merged.grid.point_index.size(), 256U);
    for (std::size_t pixel = 0; pixel < 256; ++pixel) {
      const auto found = expected.find(static_cast<std::int64_t>(pixel));
      const std::int32_t i = merged.grid.point_index[pixel];
      ASSERT_EQ(i == PixelGrid::kNone, found == expected.end());
      if (i == PixelGrid::kNone) continue;
      const Vector3d p = merged.points[static_cast<std::size_t>(i)].cast<double>();
      EXPECT_LT((p - found->second).norm(), 1e-5) << pixel;
    }
  }
}

/// The mean distance of the merged points from a slanted plane that noisy points cover.
double distance_from_plane(Random& random, float noise, int copies) {
  ImageGeometry geometry{Pose::Identity(), 100, 100, 32, 32, 64, 64};
  const Vector3f normal = Vector3f(0.8F, 0.1F, -0.6F).normalized();
  Points points;
  for (int i = 0; i < 12'000; ++i) {
    const Vector3f ray(random.uniform(-0.3F, 0.3F), random.uniform(-0.3F, 0.3F), 1);
    const float depth = normal.z() / normal.dot(ray);  // through (0, 0, 1)
    const float measured = depth * (1 + random.normal(noise));
    for (int copy = 0; copy < copies; ++copy) points.push_back(measured * ray);
  }
  const MergedPixels merged = merge_pixels(geometry, points);
  double sum = 0;
  for (std::size_t i = 0; i < merged.points.size(); ++i)
    sum += static_cast<double>(normal.dot(merged.points[i] - Vector3f(0, 0, 1)));
  return sum / static_cast<double>(merged.points.size());
}

TEST(MergePixels, KeepsAPlaneInItsPlace) {
  Random random;
  for (const float noise : {0.0F, 0.001F, 0.02F}) {
    EXPECT_NEAR(distance_from_plane(random, noise, 1), 0, 0.05 * noise + 1e-6) << noise;
    EXPECT_NEAR(distance_from_plane(random, noise, 2), 0, 0.05 * noise + 1e-6)
        << noise << ", every point twice";
  }
}

TEST(MergePixels, DoesNotReachBehindTheNearestSurface) {
  ImageGeometry geometry{Pose::Identity(), 10, 10, 4.5F, 4.5F, 10, 10};
  Points points;
  for (const float z : {5.0F, 1.0F, 1.25F}) points.push_back(z * Vector3f(0.01F, 0.02F, 1));
  const MergedPixels merged = merge_pixels(geometry, points);
  ASSERT_EQ(merged.points.size(), 1U);
  EXPECT_NEAR(merged.points[0].z(), 1.125F, 1e-6F);
  EXPECT_EQ(std::ranges::count(merged.grid.point_index, 0), 1);
  EXPECT_EQ(std::ranges::count(merged.grid.point_index, PixelGrid::kNone), 99);
  EXPECT_TRUE(merge_pixels(geometry, {}).points.empty());
}

// A few points far apart ask for an image of many pixels.
TEST(MergePixels, TakesLittleMemoryForPixelsWithoutPoints) {
  constexpr std::uint32_t kSide = 1000;
  ImageGeometry geometry{Pose::Identity(), 1000, 1000, 500, 500, kSide, kSide};
  Points points;
  for (const float x : {-0.4F, 0.4F}) points.push_back({x, 0, 1});
  const std::size_t bytes = test::bytes_in([&] { merge_pixels(geometry, points); });
  EXPECT_LT(bytes, 16 * std::size_t{kSide} * kSide) << "three numbers a pixel";
}

}  // namespace
}  // namespace trivet::kernels
