#include "engine/options/pose_limits.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/rendered_scene.hpp"

namespace trivet {
namespace {

TEST(PoseLimits, AllowEverythingByDefault) {
  EXPECT_TRUE(PoseLimits{}.allow(test::pose_of({1, 2, 3}, {4, 5, 6}), {0, 0, 0}, 1));
}

TEST(PoseLimits, HoldTheModelsCenterInABoxOfTheFilesUnit) {
  PoseLimits limits;
  limits.region = PoseLimits::Region{{-100, -100, 400}, {100, 100, 600}};  // mm
  const Eigen::Vector3f center(0.05F, 0, 0);                               // m
  EXPECT_TRUE(limits.allow(test::pose_of({0, 0, 0}, {0, 0, 0.5F}), center, 1000));
  EXPECT_FALSE(limits.allow(test::pose_of({0, 0, 0}, {0.06F, 0, 0.5F}), center, 1000))
      << "the origin is inside, the center is not";
  EXPECT_FALSE(limits.allow(test::pose_of({0, 0, 0}, {0, 0, 0.5F}), center, 1));
}

TEST(PoseLimits, HoldADirectionOfTheModelNearOneOfTheScene) {
  PoseLimits limits;
  limits.tilt = PoseLimits::Tilt{{0, 0, 2}, {0, -3, 0}, 20};
  const float right = 1.5707963F;
  EXPECT_TRUE(limits.allow(test::pose_of({right, 0, 0}, {9, 9, 9}), {0, 0, 0}, 1));
  EXPECT_TRUE(limits.allow(test::pose_of({right + 0.3F, 0, 0}, {0, 0, 0}), {0, 0, 0}, 1));
  EXPECT_FALSE(limits.allow(test::pose_of({right + 0.4F, 0, 0}, {0, 0, 0}), {0, 0, 0}, 1));
  EXPECT_FALSE(limits.allow(test::pose_of({-right, 0, 0}, {0, 0, 0}), {0, 0, 0}, 1));
}

}  // namespace
}  // namespace trivet
