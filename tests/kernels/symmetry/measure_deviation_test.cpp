#include "kernels/symmetry/measure_deviation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "kernels/common/pose_math.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr float kQuarter = std::numbers::pi_v<float> / 2;

struct Surface {
  test::SampledShape shape;

  explicit Surface(const test::Shape& made)
      : shape(test::sample_shape(made.vertices, made.triangles)) {}

  std::vector<float> deviation(const Pose& motion) const {
    std::vector<float> out(shape.points.size());
    measure_deviation(shape.points, shape.normals, shape.spacing, motion, out);
    std::ranges::sort(out);
    return out;
  }
};

Pose turn_about_origin(const Vector3f& axis, float angle) {
  return small_motion(axis * angle, Vector3f::Zero(), Vector3f::Zero());
}

TEST(MeasureDeviation, IsNothingForASymmetry) {
  const Surface block(test::box({-1, -0.8F, -0.3F}, {1, 0.8F, 0.3F}));
  for (int k = 0; k < 3; ++k)
    EXPECT_LT(block.deviation(turn_about_origin(Vector3f::Unit(k), 2 * kQuarter)).back(), 0.05F);
  const Surface can(test::prism(60, test::circle(0.5), -1, 1));
  EXPECT_LT(can.deviation(turn_about_origin(Vector3f::UnitZ(), 1)).back(), 0.05F);
}

TEST(MeasureDeviation, IsTheDifferenceOfTheSidesForAQuarterTurn) {
  const Surface block(test::box({-1, -0.8F, -0.3F}, {1, 0.8F, 0.3F}));
  const std::vector<float> all = block.deviation(turn_about_origin(Vector3f::UnitZ(), kQuarter));
  // Sides of length 1 coincide with sides of 0.8; at edges, the distance along the faces adds up to
  // the difference.
  EXPECT_GT(all.back(), 0.199F);
  EXPECT_LT(all.back(), 0.2F * std::numbers::sqrt2_v<float> + 0.01F);
  EXPECT_LT(all[all.size() / 4], 0.01F) << "top and bottom stay in their planes";
}

TEST(MeasureDeviation, GrowsWithAShift) {
  const Surface block(test::box({-1, -0.8F, -0.3F}, {1, 0.8F, 0.3F}));
  Pose shift = Pose::Identity();
  shift.translation().z() = 5;
  EXPECT_NEAR(block.deviation(shift).back(), 5, 0.05F);
}

}  // namespace
}  // namespace trivet::kernels
