#include "kernels/verification/expected_depths.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/allocations.hpp"
#include "support/rendered_bodies.hpp"
#include "support/smoothed_image.hpp"

namespace trivet::kernels {
namespace {

using test::Body;

const Body& block() {
  static const Body body({0.06F, 0.04F, 0.01F});
  return body;
}
const Pose kTurned = test::pose_of({0.1F, -0.05F, 0.3F}, {0.01F, 0.02F, 0.6F});
constexpr float kWall = 0.63F;  // within a tenth of the block's depth

struct Cast {
  RayCrop crop;
  RayHits hits;
};

Cast cast(const RangeImage& image, const Body& body, const Pose& pose) {
  Cast out{{*project_ball(image.geometry, pose.translation(), 0.5F * body.samples.diameter), 4},
           {}};
  Points directions;
  shoot_rays(image.geometry, out.crop, body.surface, pose, directions, out.hits);
  return out;
}

Column<float> expect(const RangeImage& image, const Cast& rays, float smoothing) {
  Column<float> scene, expected;
  expect_depths(image, rays.crop, rays.hits, smoothing, scene, expected);
  return expected;
}

std::size_t pixel_of(const RangeImage& image, const RayCrop& crop, int i, int j) {
  return static_cast<std::size_t>(crop.v(j)) * image.geometry.width +
         static_cast<std::size_t>(crop.u(i));
}

/// Call `body` with the ray and the pixel of each hit.
template <class Visit>
void each_hit(const RangeImage& image, const Cast& rays, const Visit& visit) {
  for (int j = 0; j < rays.crop.height; ++j) {
    for (int i = 0; i < rays.crop.width; ++i) {
      const std::size_t at = rays.crop.at(i, j);
      if (std::isfinite(rays.hits.depths[at])) visit(at, pixel_of(image, rays.crop, i, j));
    }
  }
}

TEST(ExpectedDepths, AgreeWithANaiveConvolution) {
  const RangeImage image = test::render({{&block(), kTurned}}, kWall);
  const Cast rays = cast(image, block(), kTurned);
  ASSERT_EQ(rays.crop.stride, 1);
  for (const float length : {1.0F, 2.5F, 4.0F}) {
    const RangeImage naive = test::smoothed(image, static_cast<double>(length));
    const Column<float> expected = expect(image, rays, length);
    float most = 0;
    each_hit(image, rays, [&](std::size_t at, std::size_t pixel) {
      EXPECT_NEAR(expected[at], naive.depth[pixel], 2e-5F);
      most = std::max(most, expected[at] - rays.hits.depths[at]);
    });
    EXPECT_GT(most, 0.005F) << "edges are drawn toward the wall";
  }
}

TEST(ExpectedDepths, DoNotDependOnWhatIsMeasuredOfTheModel) {
  const RangeImage image = test::render({{&block(), kTurned}}, kWall);
  const Cast rays = cast(image, block(), kTurned);
  RangeImage other = image;
  each_hit(image, rays, [&](std::size_t at, std::size_t pixel) {
    other.depth[pixel] = at % 2 == 0 ? 0.0F : 0.4F;
  });
  EXPECT_EQ(expect(other, rays, 4), expect(image, rays, 4));
}

TEST(ExpectedDepths, KeepLargeStepsAndEndAtGaps) {
  const Cast rays = cast(test::render({{&block(), kTurned}}), block(), kTurned);
  const RangeImage far = test::render({{&block(), kTurned}}, 0.8F),
                   unmeasured = test::render({{&block(), kTurned}}, 0);
  EXPECT_EQ(expect(far, rays, 4), expect(unmeasured, rays, 4));
}

TEST(ExpectedDepths, AreThoseOfTheHitsWithoutAFilter) {
  const RangeImage image = test::render({{&block(), kTurned}}, kWall);
  const Cast rays = cast(image, block(), kTurned);
  EXPECT_EQ(expect(image, rays, 0.01F), rays.hits.depths);
}

TEST(ExpectedDepths, AllocateNothingOnceTheirMemoryIsLarge) {
  const RangeImage image = test::render({{&block(), kTurned}}, kWall);
  const Cast rays = cast(image, block(), kTurned);
  Column<float> scene, expected;
  expect_depths(image, rays.crop, rays.hits, 4, scene, expected);
  EXPECT_EQ(
      test::allocations_in([&] { expect_depths(image, rays.crop, rays.hits, 4, scene, expected); }),
      0U);
}

}  // namespace
}  // namespace trivet::kernels
