#include "kernels/scans/correlated_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

constexpr std::size_t kWindow = 5;
constexpr float kNoise = 0.001F;

/// A plane in front of a small camera, with a label on all pixels.
struct Wall {
  RangeImage image;
  Plane plane;
};

/// `turn` and `distance` place the plane; `height(u, v)` is added across it.
template <class Height>
Wall wall(const Eigen::Vector3f& normal, float distance, Height&& height) {
  Wall w;
  w.image.geometry = {Pose::Identity(), 300, 300, 159.5F, 119.5F, 320, 240};
  w.plane.normal = normal.normalized();
  w.plane.offset = -distance;
  const std::size_t n = std::size_t{320} * 240;
  w.image.depth.resize(n);
  w.image.plane.assign(n, 1);
  w.image.near_plane.assign(n, 1);
  for (std::size_t pixel = 0; pixel < n; ++pixel) {
    const Eigen::Vector3f ray = w.image.geometry.back_project(pixel, 1);
    const float across = height(static_cast<float>(pixel % 320), static_cast<float>(pixel / 320));
    w.image.depth[pixel] = (w.plane.offset + across) / w.plane.normal.dot(ray);
  }
  return w;
}

CorrelatedNoise measure(const Wall& w) {
  return measure_correlated_noise(w.image, {&w.plane, 1}, kWindow);
}

float wave(float u, float v, float height, float length) {
  const float turn = 2 * 3.14159265F / length;
  return 2 * height * std::sin(turn * u) * std::sin(turn * v);
}

const Eigen::Vector3f kFacing(0, 0, -1), kSlanted(0.3F, -0.5F, -1);

TEST(CorrelatedNoise, IsNoneOfIndependentNoise) {
  test::Random random;
  const CorrelatedNoise w =
      measure(wall(kSlanted, 0.8F, [&](float, float) { return random.normal(kNoise); }));
  EXPECT_LT(w.height, 0.07F * kNoise);
  // A window's slope has an error of noise / (footprint * sqrt(sum of x^2)) = 0.053.
  EXPECT_LT(w.slope_rad, 0.01F);
}

TEST(CorrelatedNoise, IsWhatIsAddedToNoise) {
  constexpr float kHeight = 0.8F * kNoise, kLength = 20;
  for (const Eigen::Vector3f& normal : {kFacing, kSlanted}) {
    test::Random random;
    const CorrelatedNoise w = measure(wall(normal, 0.8F, [&](float u, float v) {
      return random.normal(kNoise) + wave(u, v, kHeight, kLength);
    }));
    EXPECT_NEAR(w.height, kHeight, 0.2F * kHeight) << "windows of 5 pixels flatten it a little";
    EXPECT_GT(w.slope_rad, 0.05F);
  }
}

TEST(CorrelatedNoise, GrowsWithTheUnit) {
  const auto bent = [](float unit) {
    return measure(wall(kSlanted, 0.8F * unit,
                        [&](float u, float v) { return unit * wave(u, v, kNoise, 17); }));
  };
  const CorrelatedNoise meter = bent(1), millimeter = bent(1000);
  EXPECT_NEAR(millimeter.height, 1000 * meter.height, 1e-2F * 1000 * meter.height);
  EXPECT_NEAR(millimeter.slope_rad, meter.slope_rad, 1e-2F * meter.slope_rad);
}

TEST(CorrelatedNoise, SparesABendThatPosesAbsorb) {
  const auto bow = [](float u, float) { return 4e-7F * (u - 160) * (u - 160); };  // 1 cm in all
  EXPECT_LT(measure(wall(kFacing, 0.8F, bow)).height, 1e-4F);
}

TEST(CorrelatedNoise, IsNotGuessedFromAFewPatches) {
  Wall w = wall(kFacing, 0.8F, [](float u, float v) { return wave(u, v, kNoise, 17); });
  EXPECT_GT(measure(w).height, 0.5F * kNoise);
  for (std::size_t pixel = 0; pixel < w.image.depth.size(); ++pixel) {
    const bool in_patch =
        pixel % 320 < kPatch * kWindow * (kFewestPatches - 1) && pixel / 320 < kPatch * kWindow;
    if (!in_patch) w.image.near_plane[pixel] = 0;
  }
  EXPECT_EQ(measure(w).height, 0);
  EXPECT_EQ(measure(w).slope_rad, 0);
}

}  // namespace
}  // namespace trivet::kernels
