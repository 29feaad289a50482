#include "kernels/verification/camera_scale.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "kernels/verification/ray_crop.hpp"
#include "support/random.hpp"
#include "support/ray_image.hpp"
#include "support/rendered_scene.hpp"

namespace trivet::kernels {
namespace {

using Vector8 = ObjectEquations::Vector8;

constexpr double kPriorInformation = 100;  // of a tenth

/// Brackets in front of a wall, seen by one camera, and their equations.
struct Brackets {
  test::Shape shape = test::bracket();
  RayScene surface = *RayScene::from_mesh(shape.vertices, shape.triangles);
  std::vector<Pose> poses{test::pose_of({2.1F, 0.7F, -0.4F}, {-0.15F, 0.05F, 0.85F}),
                          test::pose_of({-0.6F, 0.5F, 1.9F}, {0.15F, -0.02F, 0.95F}),
                          test::pose_of({1.2F, -1.8F, 0.3F}, {0.01F, 0.1F, 0.75F})};
  RangeImage image =
      test::measure({Pose::Identity(), 570, 570, 319.5F, 239.5F, 640, 480}, surface, poses, 1.4F);
  ModelSamples samples{shape.vertices, {}, {}, 0.001F, 0.2F, {0, 0, 0.04F}};

  /// Gauss-Newton iterations from the true poses. Returns the pulls at the end.
  std::vector<ScalePull> settle(float correlation = 0, float measured = 1) {
    for (float& depth : image.depth) depth *= measured;
    std::vector<Pose> at = poses;
    std::vector<ScalePull> pulls;
    LogScales scales;
    ScaleScratch scratch;
    for (int step = 0; step < 6; ++step) {
      std::vector<ObjectEquations> equations(at.size());
      pulls.clear();
      for (std::size_t k = 0; k < at.size(); ++k) {
        gather_object(image, {surface, samples, at[k]}, scales, {0.001F, 0.03F, 2}, scratch,
                      equations[k]);
        EXPECT_GT(equations[k].num_used, 200U);
        EXPECT_LE(equations[k].num_rays, 2600U);
        pulls.push_back(leave_pose_free(equations[k], scales));
        pulls.back().correlation = correlation;
      }
      const CameraScale found = estimate_scales(pulls);
      const LogScales now{std::log(found.focal.value),
                          found.depth ? std::log(found.depth->value) : 0};
      for (std::size_t k = 0; k < at.size(); ++k) {
        at[k] = follow_scales(equations[k], {now.focal - scales.focal, now.depth - scales.depth},
                              at[k], samples.center);
      }
      scales = now;
    }
    return pulls;
  }
};

ObjectEquations random_equations(test::Random& random) {
  ObjectEquations equations;
  for (int row = 0; row < 30; ++row) {
    Vector8 J;
    for (int i = 0; i < 8; ++i) J[i] = static_cast<double>(random.uniform(-1, 1));
    const double r = static_cast<double>(random.uniform(-0.1F, 0.1F));
    equations.information += 100 * J * J.transpose();
    equations.blocks.push_back(100 * r * J);
    equations.pull += equations.blocks.back();
  }
  return equations;
}

TEST(EstimateScales, FindsTheFocalLengthThatIsWrittenWrong) {
  for (const double wrong : {0.96, 1.0, 1.02, 1.04}) {
    Brackets brackets;
    brackets.image.geometry.fx *= static_cast<float>(wrong);
    brackets.image.geometry.fy *= static_cast<float>(wrong);
    const CameraScale found = estimate_scales(brackets.settle());
    EXPECT_NEAR(found.focal.value, 1 / wrong, 0.002);
    ASSERT_TRUE(found.depth);
    EXPECT_NEAR(found.depth->value, 1, 0.002);
    EXPECT_LT(found.focal.error, 0.005);
  }
}

TEST(EstimateScales, FindsTheDepthScaleThatIsWrittenWrong) {
  for (const double wrong : {0.99, 1.01}) {
    Brackets brackets;
    const CameraScale found = estimate_scales(brackets.settle(0, static_cast<float>(wrong)));
    ASSERT_TRUE(found.depth);
    EXPECT_NEAR(found.depth->value, 1 / wrong, 0.002);
    EXPECT_NEAR(found.focal.value, 1, 0.002);
  }
}

TEST(EstimateScales, KeepsDepthWhereNeighborsErrAlike) {
  Brackets brackets;
  const CameraScale found = estimate_scales(brackets.settle(1));
  EXPECT_FALSE(found.depth);
  EXPECT_NEAR(found.focal.value, 1, 0.005);
  EXPECT_GT(found.focal.error, 0.015);
}

// All poses and both scales are the unknowns of one dense system.
TEST(EstimateScales, AgreesWithTheJointSolutionOfAllPosesAndScales) {
  test::Random random;
  constexpr Eigen::Index kObjects = 5;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6 * kObjects + 2, 6 * kObjects + 2);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(6 * kObjects + 2);
  A.bottomRightCorner<2, 2>() = kPriorInformation * Eigen::Matrix2d::Identity();
  std::vector<ScalePull> pulls;
  for (Eigen::Index k = 0; k < kObjects; ++k) {
    const ObjectEquations one = random_equations(random);
    A.block<6, 6>(6 * k, 6 * k) = one.information.topLeftCorner<6, 6>();
    A.block<6, 2>(6 * k, 6 * kObjects) = one.information.topRightCorner<6, 2>();
    A.block<2, 6>(6 * kObjects, 6 * k) = one.information.bottomLeftCorner<2, 6>();
    A.bottomRightCorner<2, 2>() += one.information.bottomRightCorner<2, 2>();
    b.segment<6>(6 * k) = one.pull.head<6>();
    b.tail<2>() += one.pull.tail<2>();
    pulls.push_back(leave_pose_free(one, {}));
  }
  const Eigen::Vector2d joint = A.ldlt().solve(b).tail<2>();
  const CameraScale found = estimate_scales(pulls);
  EXPECT_NEAR(std::log(found.focal.value), joint[0], 1e-6);
  EXPECT_NEAR(std::log(found.depth->value), joint[1], 1e-6);
}

TEST(GatherObject, UsesOnlyTheImageForAPoseNextToTheCamera) {
  Brackets brackets;
  ScaleScratch scratch;
  ObjectEquations equations;
  const float radius = 0.5F * ball_diameter(brackets.samples);
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3f(60, 0, 1.06F * radius) - brackets.samples.center;
  gather_object(brackets.image, {brackets.surface, brackets.samples, pose}, {}, {0.001F, 0.03F, 2},
                scratch, equations);
  EXPECT_GT(equations.num_rays, 0U);
  EXPECT_EQ(equations.num_used, 0U);
  EXPECT_LE(equations.blocks.size(), 2000U);  // 640 x 480 pixels, and a margin, by 16 x 16
}

TEST(EstimateScales, DependsOnNoOrderOfTheObjects) {
  test::Random random;
  std::vector<ScalePull> pulls;
  for (std::uint32_t k = 0; k < 6; ++k) {
    pulls.push_back(leave_pose_free(random_equations(random), {}));
    pulls.back().model = k % 3;
  }
  const CameraScale before = estimate_scales(pulls);
  std::ranges::reverse(pulls);
  const CameraScale after = estimate_scales(pulls);
  EXPECT_NEAR(before.focal.value, after.focal.value, 1e-12);
  EXPECT_NEAR(before.focal.error, after.focal.error, 1e-12);
  EXPECT_NEAR(before.depth->value, after.depth->value, 1e-12);
  EXPECT_NEAR(before.num_models, after.num_models, 1e-12);
}

TEST(EstimateScales, IsLessSureWhereModelsDisagree) {
  std::vector<ScalePull> pulls(4);
  for (std::uint32_t k = 0; k < 4; ++k) {
    pulls[k].model = k / 2;
    pulls[k].information = 1e6 * Eigen::Matrix2d::Identity();
    pulls[k].scatter = pulls[k].information;
  }
  const double agreeing = estimate_scales(pulls).focal.error;
  for (std::uint32_t k = 0; k < 4; ++k) pulls[k].pull[0] = k < 2 ? 1e4 : -1e4;  // by 1 %
  EXPECT_LT(agreeing, 0.002);
  EXPECT_NEAR(estimate_scales(pulls).focal.error, 0.01, 0.0005);
}

TEST(LeavePoseFree, GivesTheSameFromWhereverTheEquationsWereSetUp) {
  test::Random random;
  ObjectEquations equations = random_equations(random);
  const ScalePull at_one = leave_pose_free(equations, {});
  const Eigen::Vector2d moved(0.03, -0.01);
  equations.pull -= equations.information.rightCols<2>() * moved;
  const ScalePull elsewhere = leave_pose_free(equations, {moved[0], moved[1]});
  EXPECT_LT((at_one.pull - elsewhere.pull).norm(), 1e-9 * at_one.information.norm());
}

}  // namespace
}  // namespace trivet::kernels
