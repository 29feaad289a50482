#include "kernels/symmetry/refine_alignment.hpp"

#include <gtest/gtest.h>

#include "kernels/common/pose_math.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

/// A block with a shoulder, and a post of some height on it.
test::SampledShape block_with_post(float height, std::uint64_t seed) {
  test::Shape shape = test::box({-0.05F, -0.03F, 0}, {0.05F, 0.03F, 0.02F});
  shape.join(test::box({-0.05F, -0.03F, 0.02F}, {-0.02F, 0, 0.035F}));
  if (height > 0) shape.join(test::box({0.02F, 0, 0.02F}, {0.03F, 0.01F, 0.02F + height}));
  return test::sample_shape(shape.vertices, shape.triangles, seed);
}

constexpr float kCoincident = 0.001F;

Pose small_move(const Vector3f& turn, const Vector3f& shift) {
  return small_motion(turn, shift, Vector3f::Zero());
}

TEST(RefineAlignment, BringsACopyOntoTheSurface) {
  const test::SampledShape surface = block_with_post(0, 1), other = block_with_post(0, 2);
  const RefinedAlignment found =
      refine_alignment(surface.view(), other.view(), kCoincident,
                       small_move({0.02F, -0.03F, 0.02F}, {0.001F, 0.0015F, -0.001F}));
  EXPECT_LT(found.T_this_other.translation().norm(), 1e-4F);
  EXPECT_LT(rotation_angle(found.T_this_other.linear(), Eigen::Matrix3f::Identity()), 2e-3F);
  EXPECT_GT(found.agreeing, 0.98F);
}

TEST(RefineAlignment, IsNotMovedByWhatTheSurfacesDoNotHaveInCommon) {
  const test::SampledShape surface = block_with_post(0, 1), other = block_with_post(0.02F, 2);
  for (const bool swapped : {false, true}) {
    const RefinedAlignment found = refine_alignment(
        swapped ? other.view() : surface.view(), swapped ? surface.view() : other.view(),
        kCoincident, small_move({0.02F, 0, 0.02F}, {0.001F, 0, -0.001F}));
    EXPECT_LT(found.T_this_other.translation().norm(), 1e-4F);
    EXPECT_LT(rotation_angle(found.T_this_other.linear(), Eigen::Matrix3f::Identity()), 2e-3F);
    EXPECT_GT(found.agreeing, 0.9F);
    if (!swapped) {
      EXPECT_LT(found.agreeing, 0.98F) << "the post lies on nothing";
    }
  }
}

TEST(RefineAlignment, MovesWithTheFrames) {
  const test::SampledShape surface = block_with_post(0, 1);
  test::SampledShape other = block_with_post(0.02F, 2);
  const Pose motion = small_move({0.4F, -1.1F, 0.3F}, {0.2F, 0.1F, -0.3F});
  for (std::size_t i = 0; i < other.points.size(); ++i) {
    other.points.set(i, motion * other.points[i]);
    other.normals.set(i, motion.linear() * other.normals[i]);
  }
  const RefinedAlignment found =
      refine_alignment(surface.view(), other.view(), kCoincident,
                       motion.inverse() * small_move({0.02F, 0, 0}, {0, 0, 0}));
  EXPECT_LT((found.T_this_other * motion).translation().norm(), 2e-4F);
}

TEST(RefineAlignment, AgreesLittleForAnotherShape) {
  const test::Shape ball = test::ellipsoid({0.05F, 0.03F, 0.02F}, 24);
  const test::SampledShape surface = block_with_post(0, 1),
                           other = test::sample_shape(ball.vertices, ball.triangles);
  EXPECT_LT(refine_alignment(surface.view(), other.view(), kCoincident, Pose::Identity()).agreeing,
            0.5F);
}

}  // namespace
}  // namespace trivet::kernels
