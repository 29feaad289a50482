#include "kernels/verification/pose_covariance.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "kernels/common/pose_math.hpp"
#include "support/random.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using Vector6 = Eigen::Matrix<double, 6, 1>;

const Pose kPosed = test::pose_of({0.4F, -0.7F, 1.1F}, {0.1F, 0.2F, 0.9F});
const Vector3f kMiddle(0.02F, -0.01F, 0.03F);
constexpr float kRadius = 0.1F;

/// Equations of points on three perpendicular faces of the model, each measured to a deviation.
PoseEquations corner_equations(double deviation) {
  PoseEquations equations;
  test::Random random(3);
  for (int k = 0; k < 600; ++k) {
    const Vector3f n = Vector3f::Unit(k % 3);
    Vector3f p(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    p = kRadius * (p - n.dot(p) * n + n);
    const Vector3f arm = kPosed.linear() * p / kRadius, normal = kPosed.linear() * n;
    Vector6 J;
    J << arm.cross(normal).cast<double>(), normal.cast<double>();
    equations.held += J * J.transpose() / (deviation * deviation);
  }
  return equations;
}

// Noise on the faces moves the solution of the equations; the covariance tells by how much.
TEST(PoseCovariance, IsTheScatterOfSolutionsUnderNoise) {
  constexpr double kDeviation = 1e-3;
  const PoseEquations equations = corner_equations(kDeviation);
  const Eigen::Matrix<double, 6, 6> root = equations.held.llt().matrixL();
  Eigen::Matrix<double, 6, 6> scatter = Eigen::Matrix<double, 6, 6>::Zero();
  test::Random random(5);
  constexpr int kTrials = 4000;
  for (int k = 0; k < kTrials; ++k) {
    Vector6 noise;
    for (double& value : noise) value = static_cast<double>(random.normal(1));
    const Vector6 x = equations.held.ldlt().solve(root * noise);
    const Pose moved = small_motion((x.head<3>() / static_cast<double>(kRadius)).cast<float>(),
                                    x.tail<3>().cast<float>(), kPosed * kMiddle) *
                       kPosed;
    const Pose motion = kPosed.inverse() * moved;
    const Eigen::AngleAxisf turn(motion.linear());
    Vector6 error;
    error << (motion * kMiddle - kMiddle).cast<double>(),
        (turn.angle() * turn.axis()).cast<double>();
    scatter += error * error.transpose() / kTrials;
  }
  const PoseCovariance covariance = pose_covariance(equations, kPosed, kMiddle, kRadius, 0, {});
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double scale = std::sqrt(scatter(i, i) * scatter(j, j));
      EXPECT_NEAR(static_cast<double>(covariance(i, j)), scatter(i, j), 0.08 * scale) << i << j;
    }
  }
}

TEST(PoseCovariance, DoesNotDependOnWhereTheScanIs) {
  PoseEquations turned;  // the same measurements in a scene that is turned
  const Pose motion = test::pose_of({1, 0.3F, -0.4F}, {3, -2, 1});
  const PoseEquations equations = corner_equations(1e-3);
  Eigen::Matrix<double, 6, 6> R = Eigen::Matrix<double, 6, 6>::Zero();
  R.topLeftCorner<3, 3>() = R.bottomRightCorner<3, 3>() = motion.linear().cast<double>();
  turned.held = R * equations.held * R.transpose();
  const PoseCovariance a = pose_covariance(equations, kPosed, kMiddle, kRadius, 0, {});
  const PoseCovariance b = pose_covariance(turned, motion * kPosed, kMiddle, kRadius, 0, {});
  EXPECT_LT((a - b).norm(), 1e-4F * a.norm());
}

TEST(PoseCovariance, IsAsLargeAsTheModelWhereNothingIsMeasured) {
  const Eigen::Matrix<float, 6, 1> sigma =
      pose_sigma(pose_covariance({}, kPosed, kMiddle, kRadius, 0, {}));
  EXPECT_LT((sigma.head<3>() - Vector3f::Constant(kRadius)).norm(), 1e-5F);
  EXPECT_LT((sigma.tail<3>() - Vector3f::Constant(1)).norm(), 1e-5F);
}

TEST(PoseCovariance, TellsTheLeastCertainDirectionOfThePosition) {
  PoseCovariance covariance = PoseCovariance::Identity();
  const Eigen::Matrix3f R = Eigen::AngleAxisf(0.7F, Vector3f(1, 2, 3).normalized()).matrix();
  covariance.topLeftCorner<3, 3>() = R * Vector3f(1, 9, 4).asDiagonal() * R.transpose();
  EXPECT_NEAR(largest_shift(covariance), 3, 1e-5F);
}

TEST(PoseCovariance, IsAtLeastWhatAllMeasurementsShare) {
  constexpr float kShared = 0.004F;
  const PoseEquations many = corner_equations(1e-5);
  const Eigen::Matrix<float, 6, 1> sigma =
      pose_sigma(pose_covariance(many, kPosed, kMiddle, kRadius, kShared, {}));
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sigma[k], kShared, 1e-5F);
    EXPECT_NEAR(sigma[k + 3], kShared / kRadius, 1e-4F);
  }
}

TEST(PoseCovariance, CountsNoTurnAboutAnAxisOfSymmetry) {
  Symmetry::Axis axis;
  axis.direction = Vector3f::UnitY();
  axis.point = Vector3f(0.05F, 0, 0);
  const Eigen::Matrix<float, 6, 1> sigma =
      pose_sigma(pose_covariance({}, kPosed, kMiddle, kRadius, 0, axis));
  EXPECT_LT(sigma[4], 1e-5F);
  EXPECT_NEAR(sigma[3], 1, 1e-5F);
  EXPECT_NEAR(sigma[5], 1, 1e-5F);
}

}  // namespace
}  // namespace trivet::kernels
