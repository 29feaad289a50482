#include "kernels/scans/plane_patches.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

/// A wall that a camera looks straight at, 40 x 30 pixels of 1 cm, with these labels.
RangeImage wall(const std::vector<std::uint8_t>& labels) {
  RangeImage image;
  image.geometry = {Pose::Identity(), 100, 100, 19.5F, 14.5F, 40, 30};
  image.depth.assign(1200, 1);
  image.near_plane.assign(labels.begin(), labels.end());
  return image;
}

std::vector<std::uint8_t> labels_of(const std::vector<std::array<int, 5>>& boxes) {
  std::vector<std::uint8_t> labels(1200, 0);
  for (const auto& [u0, v0, u1, v1, label] : boxes) {
    for (int v = v0; v < v1; ++v) {
      for (int u = u0; u < u1; ++u)
        labels[static_cast<std::size_t>(40 * v + u)] = static_cast<std::uint8_t>(label);
    }
  }
  return labels;
}

const Plane kWall{Vector3f(0, 0, -1), -1, 0, 0.01F};

TEST(LargestPatches, AreOfConnectedPixelsOfOnePlane) {
  // Two parts beside one another, and one that touches a corner of the first.
  const RangeImage image = wall(
      labels_of({{2, 2, 12, 8, 1}, {14, 2, 30, 8, 1}, {12, 8, 16, 12, 1}, {0, 20, 40, 30, 2}}));
  const std::vector<float> patches = largest_patches(image, std::vector<Plane>{kWall, kWall});
  ASSERT_EQ(patches.size(), 2U);
  EXPECT_NEAR(patches[0], (16 * 6 + 4 * 4) * 1e-4F, 1e-6F) << "the second and the corner piece";
  EXPECT_NEAR(patches[1], 400 * 1e-4F, 1e-6F);
}

TEST(LargestPatches, DoNotGoOnAtTheImagesOtherSide) {
  const RangeImage image = wall(labels_of({{36, 2, 40, 10, 1}, {0, 3, 3, 11, 1}}));
  EXPECT_NEAR(largest_patches(image, std::vector<Plane>{kWall})[0], 32 * 1e-4F, 1e-6F);
}

TEST(LargestPatches, AreAreasOfTheSlantedPlane) {
  RangeImage image = wall(labels_of({{10, 10, 30, 20, 1}}));
  const Vector3f normal = Vector3f(1, 0, -1).normalized();
  const Plane slanted{normal, normal.dot(Vector3f(0, 0, 1)), 0, 0.01F};
  double expected = 0;
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const Vector3f ray = image.geometry.back_project(pixel, 1);
    image.depth[pixel] = slanted.offset / normal.dot(ray);
    if (image.near_plane[pixel] == 0) continue;
    // Two sides of the pixel on the plane.
    const auto at = [&](float du, float dv) {
      const Vector3f r(ray.x() + du / 100, ray.y() + dv / 100, 1);
      return Vector3f(slanted.offset / normal.dot(r) * r);
    };
    expected +=
        static_cast<double>((at(0.5F, 0) - at(-0.5F, 0)).cross(at(0, 0.5F) - at(0, -0.5F)).norm());
  }
  EXPECT_NEAR(static_cast<double>(largest_patches(image, std::vector<Plane>{slanted})[0]), expected,
              0.01 * expected);
}

TEST(LargestPatches, AreEmptyOfAnImageWithoutPlanes) {
  EXPECT_TRUE(largest_patches(wall(labels_of({})), {}).empty());
  EXPECT_EQ(largest_patches(wall(labels_of({})), std::vector<Plane>{kWall}), std::vector<float>{0});
}

}  // namespace
}  // namespace trivet::kernels
