#include "kernels/verification/edge_equations.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "kernels/common/pose_math.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "support/rendered_bodies.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Body;
using test::brick;
using test::kFar;
using test::render;

constexpr float kAgreement = 0.003F;  // tolerance of the examinations

/// The equations of an examination with measurements that err by a tenth of the tolerance.
PoseEquations equations_of(const RangeImage& image, const Body& body, const Pose& pose) {
  ExamineOptions options;
  options.verify.tolerance = kAgreement;
  options.error = 0.1F * kAgreement;
  ExamineScratch scratch;
  PoseEquations equations;
  examine_pose({&image, 1}, {body.surface, body.samples, pose}, {}, options, scratch,
               {.equations = &equations});
  return equations;
}

/// The pose after a few steps by these equations.
Pose solved(const RangeImage& image, const Body& body, Pose pose) {
  for (int step = 0; step < 4; ++step) {
    const PoseEquations e = equations_of(image, body, pose);
    const Eigen::Matrix<double, 6, 1> x = e.information.ldlt().solve(e.gradient);
    const double radius = 0.5 * static_cast<double>(body.samples.diameter);
    pose = small_motion((x.head<3>() / radius).cast<float>(), x.tail<3>().cast<float>(),
                        pose.translation()) *
           pose;
  }
  return pose;
}

/// The front of a brick, as a camera sees it that looks straight at it: 50 x 30 pixels.
const Pose kFacing = test::pose_of({0, 0, 0}, {0.01F, -0.02F, 0.64F});
constexpr float kPixel = 0.6F / 150;

TEST(PoseEquations, LeadAFlatFaceThatSlidBackToItsEnds) {
  const RangeImage image = render({{&brick(), kFacing}});
  for (const Vector3f& slide :
       {Vector3f(4, 0, 0), Vector3f(-3, 5, 0), Vector3f(0.6F, -0.4F, 0), Vector3f(0, 0, 0.4F)}) {
    const Pose start = Eigen::Translation3f(kPixel * slide) * kFacing;
    const Pose found = solved(image, brick(), start);
    EXPECT_LT((found.translation() - kFacing.translation()).norm(), 0.6F * kPixel)
        << slide.transpose();
    EXPECT_LT(rotation_angle(found.linear(), kFacing.linear()), 0.01F);
  }
  const Pose turned = test::pose_of({0, 0, 0.1F}, kFacing.translation());
  EXPECT_LT(rotation_angle(solved(image, brick(), turned).linear(), kFacing.linear()), 0.01F);
}

/// Information on a slide along x.
double information_on_slide(const RangeImage& image) {
  return equations_of(image, brick(), kFacing).information(3, 3);
}

TEST(PoseEquations, HoldASlideByEdgesAloneWhereTheSceneFallsBack) {
  RangeImage image = render({{&brick(), kFacing}});
  EXPECT_GT(information_on_slide(image), 1 / static_cast<double>(kPixel * kPixel));
  RangeImage unmeasured = image;
  for (float& depth : unmeasured.depth) depth = depth == kFar ? 0 : depth;
  EXPECT_LT(information_on_slide(unmeasured), 1) << "the face may go on there";
  RangeImage in_contact = image;
  for (float& depth : in_contact.depth) depth = depth == kFar ? 0.6F : depth;
  EXPECT_LT(information_on_slide(in_contact), 1) << "the face goes on";
}

const Pose kTilted = test::pose_of({0.6F, -0.5F, 0.3F}, {0.02F, -0.01F, 0.6F});

// In a window, shared errors do not average out.
TEST(PoseEquations, CountCorrelatedErrorsOncePerWindow) {
  const RangeImage image = render({{&brick(), kTilted}});
  ExamineOptions options;
  options.verify.tolerance = kAgreement;
  options.error = 0.1F * kAgreement;
  options.window = 2;
  const auto depth_information = [&](float shared) {
    options.correlated_noise.height = shared;
    ExamineScratch scratch;
    PoseEquations e;
    examine_pose({&image, 1}, {brick().surface, brick().samples, kTilted}, {}, options, scratch,
                 {.equations = &e});
    return e.information(5, 5);
  };
  // Every second pixel has a ray, and a window 5 x 5 pixels.
  EXPECT_NEAR(depth_information(0) / depth_information(0.2F * kAgreement), 1 + 25.0 / 4 * 4, 1);
}

}  // namespace
}  // namespace trivet::kernels
