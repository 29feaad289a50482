#include "kernels/symmetry/align_shapes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kernels/common/pose_math.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using test::box;
using test::SampledShape;
using test::Shape;

constexpr float kDegree = std::numbers::pi_v<float> / 180;

SampledShape sampled(const Shape& shape, std::uint64_t seed) {
  SampledShape surface = test::sample_shape(shape.vertices, shape.triangles, seed);
  surface.diameter = find_diameter(shape.vertices);
  return surface;
}

Pose moved(const Eigen::Vector3f& turn, const Eigen::Vector3f& shift) {
  return small_motion(turn, shift, Eigen::Vector3f::Zero());
}

/// A plate with a rib and a post, without symmetry.
Shape plate() {
  Shape shape = box({-0.08F, -0.05F, 0}, {0.08F, 0.05F, 0.02F});
  shape.join(box({-0.07F, -0.04F, 0.02F}, {-0.03F, 0.01F, 0.09F}));
  return shape.join(box({0.02F, 0.01F, 0.02F}, {0.06F, 0.03F, 0.04F}));
}

std::vector<ShapeAligner::Alignment> align(const Shape& shape, const Shape& other) {
  const SampledShape own = sampled(shape, 1), its = sampled(other, 2);
  return ShapeAligner(own.points, own.normals, shape_frame(own.points), own.diameter)
      .align(its.points, shape_frame(its.points));
}

TEST(ShapeFrame, MovesWithTheSamples) {
  const SampledShape surface = sampled(plate(), 1);
  const Pose motion = moved({0.3F, -1.2F, 0.8F}, {0.5F, 0.1F, -0.7F});
  Points points;
  for (std::size_t i = 0; i < surface.points.size(); ++i)
    points.push_back(motion * surface.points[i]);
  const ShapeFrame before = shape_frame(surface.points), after = shape_frame(points);
  EXPECT_LT((after.center - motion * before.center).norm(), 1e-5F);
  EXPECT_LT((after.deviations - before.deviations).norm(), 1e-5F);
  EXPECT_LT(before.deviations[0], before.deviations[1]);
  EXPECT_LT(before.deviations[1], before.deviations[2]);
  EXPECT_NEAR(after.axes.determinant(), 1, 1e-4F);
  const Eigen::Matrix3f same = after.axes.transpose() * motion.linear() * before.axes;
  EXPECT_LT((same.cwiseAbs() - Eigen::Matrix3f::Identity()).norm(), 1e-3F) << "but for its sign";
}

TEST(ShapeAligner, FindsWhereAMovedCopyLies) {
  const Pose motion = moved({0.3F, -1.2F, 0.8F}, {0.5F, 0.1F, -0.7F});
  const auto found = align(plate(), plate().moved(motion));
  ASSERT_FALSE(found.empty());
  const PoseDistance error =
      pose_distance(found[0].T_this_other, motion.inverse(), {}, motion * Eigen::Vector3f::Zero());
  EXPECT_LT(error.rotation_rad, 4 * kDegree);
  EXPECT_LT(error.translation, 0.01F);
  EXPECT_LT(found[0].distance, 0.01F);
}

TEST(ShapeAligner, TurnsWhatIsSpreadEvenlyAboutAnAxis) {
  const Shape square = test::prism(4, test::polygon(4), -0.3, 0.3, 0.4);
  for (const float degrees : {10.0F, 37.0F, 45.0F, 70.0F}) {
    const auto found = align(square, square.moved(moved({0, 0, degrees * kDegree}, {2, 0, 1})));
    ASSERT_FALSE(found.empty()) << degrees;
    const Eigen::Matrix3f turned =
        found[0].T_this_other.linear() *
        Eigen::AngleAxisf(degrees * kDegree, Eigen::Vector3f::UnitZ()).toRotationMatrix();
    const float about = std::atan2(turned(1, 0), turned(0, 0)) / kDegree;
    EXPECT_GT(std::abs(turned(2, 2)), 0.99F) << degrees;
    EXPECT_LT(std::abs(std::remainder(about, 90.0F)), 9) << degrees;
  }
}

// One knob tells the half turns of a block apart, and little of its surface.
TEST(ShapeAligner, FindsTheHalfTurnsOfABlock) {
  Shape block = box({-0.1F, -0.06F, -0.03F}, {0.1F, 0.06F, 0.03F});
  block.join(box({0.05F, 0.02F, 0.03F}, {0.07F, 0.04F, 0.035F}));
  const auto found = align(block, block);
  ASSERT_EQ(found.size(), 4U);
  for (const Eigen::Vector3f& axis :
       {Eigen::Vector3f(Eigen::Vector3f::UnitX()), Eigen::Vector3f(Eigen::Vector3f::UnitY()),
        Eigen::Vector3f(Eigen::Vector3f::UnitZ())}) {
    EXPECT_TRUE(std::ranges::any_of(found, [&](const ShapeAligner::Alignment& one) {
      const Eigen::Vector3f turned = one.T_this_other.linear() * axis;
      return turned.dot(axis) > 0.99F && one.T_this_other.linear().trace() < 0;
    })) << axis.transpose();
  }
}

TEST(ShapeAligner, FindsNothingInAnotherShape) {
  EXPECT_TRUE(align(plate(), box({-0.1F, -0.01F, -0.01F}, {0.1F, 0.01F, 0.01F})).empty());
  EXPECT_TRUE(align(plate(), box({-0.05F, -0.05F, -0.05F}, {0.05F, 0.05F, 0.05F})).empty());
}

}  // namespace
}  // namespace trivet::kernels
