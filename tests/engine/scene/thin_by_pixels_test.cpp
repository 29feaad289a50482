#include "engine/scene/thin_by_pixels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace trivet {
namespace {

constexpr std::uint32_t kNear = 600, kFar = 5400;

/// As many points a square meter at 1 m as at 3 m, on surfaces that fill as many pixels.
engine::PreparedScene near_and_far() {
  engine::PreparedScene scene;
  scene.view.kind = SceneKind::image;
  scene.images.emplace_back().geometry = {Pose::Identity(), 500, 500, 319.5F, 239.5F, 640, 480};
  for (std::uint32_t k = 0; k < kNear + kFar; ++k)
    scene.points.push_back({0.001F * static_cast<float>(k), 0, k < kNear ? 1.0F : 3.0F});
  return scene;
}

std::vector<std::uint32_t> kept(const engine::PreparedScene& scene, std::size_t limit) {
  std::vector<std::uint32_t> indices(scene.points.size());
  std::iota(indices.begin(), indices.end(), 0U);
  indices.resize(engine::thin_by_pixels(scene, scene.points, limit, indices));
  return indices;
}

TEST(ThinByPixels, GivesNearAndFarSurfacesTheirShareOfTheImage) {
  const std::vector<std::uint32_t> some = kept(near_and_far(), 300);
  EXPECT_EQ(some.size(), 300U);
  EXPECT_TRUE(std::ranges::is_sorted(some));
  EXPECT_EQ(std::ranges::adjacent_find(some), some.end()) << "kept twice";
  const auto num_near = std::ranges::lower_bound(some, kNear) - some.begin();
  EXPECT_TRUE(num_near >= 149 && num_near <= 151) << num_near;
}

TEST(ThinByPixels, IsNotMisledByPointsAtTheSensor) {
  engine::PreparedScene scene = near_and_far();
  for (const float range : {0.0F, 1e-6F, -1.0F, 1e-3F}) scene.points.push_back({0, 0, range});
  EXPECT_GE(kept(scene, 300).size(), 298U);
}

TEST(ThinByPixels, DoesNotDependOnTheUnit) {
  engine::PreparedScene scene = near_and_far();
  const std::vector<std::uint32_t> in_meters = kept(scene, 300);
  for (std::size_t i = 0; i < scene.points.size(); ++i) scene.points.set(i, 1024 * scene.points[i]);
  EXPECT_EQ(kept(scene, 300), in_meters);
}

TEST(ThinByPixels, SpreadsOverAClosedSurfaceEvenly) {
  engine::PreparedScene scene = near_and_far();
  scene.view.kind = SceneKind::surface;
  const std::vector<std::uint32_t> some = kept(scene, 300);
  for (std::uint32_t k = 0; k < 300; ++k) EXPECT_EQ(some[k], 20 * k);
}

TEST(ThinByPixels, KeepsAllWithinTheLimitAndNoneIfItIsNull) {
  const engine::PreparedScene scene = near_and_far();
  EXPECT_EQ(kept(scene, kNear + kFar).size(), kNear + kFar);
  EXPECT_EQ(kept(scene, kNear + kFar - 1).size(), kNear + kFar - 1);
  EXPECT_TRUE(kept(scene, 0).empty());
}

}  // namespace
}  // namespace trivet
