#include "kernels/verification/reach_behind.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numbers>

#include "support/random.hpp"
#include "support/rendered_scene.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

constexpr float kOnPlane = 0.001F;

/// A screw whose head, of radius 2, rests on z = 0, with a shank of radius 1 below [cm].
test::SampledShape headed_screw() {
  test::Shape shape = test::prism(64, test::circle(0.02), 0, 0.01);
  shape.join(test::prism(64, test::circle(0.01), -0.04, 0.0));
  return test::sample_shape(shape.vertices, shape.triangles, 1, 16384);
}

const Plane kSlab{Vector3f(0, 0, 1), 0, 1, kOnPlane};

TEST(ReachBehind, MeasuresTheShankAndTheHeadOfAScrew) {
  const test::SampledShape sampled = headed_screw();
  const PlaneReach reach = reach_behind(sampled.view(), Pose::Identity(), kSlab, kOnPlane);
  EXPECT_NEAR(reach.depth, 0.04F, 1e-5F);
  EXPECT_NEAR(reach.deepest.z(), -0.04F, 1e-5F);
  const float square = sampled.spacing * sampled.spacing,
              circle = std::numbers::pi_v<float> * 1e-4F;
  EXPECT_NEAR(reach.entering * square, circle, 0.1F * circle);
  EXPECT_NEAR(reach.bearing * square, 3 * circle, 0.1F * circle) << "the shank's top is no surface";
  const Pose lifted = test::pose_of({0, 0, 0}, {0, 0, 0.5F * kOnPlane});
  EXPECT_EQ(reach_behind(sampled.view(), lifted, kSlab, kOnPlane).bearing, reach.bearing);
  // A screw whose head is above the plane bears on nothing.
  const Pose raised = test::pose_of({0, 0, 0}, {0, 0, 0.01F});
  EXPECT_EQ(reach_behind(sampled.view(), raised, kSlab, kOnPlane).bearing, 0);
  // The head of one that is sunk enters, too.
  const Pose sunk = test::pose_of({0, 0, 0}, {0, 0, -0.005F});
  const PlaneReach deeper = reach_behind(sampled.view(), sunk, kSlab, kOnPlane);
  EXPECT_EQ(deeper.bearing, 0);
  EXPECT_NEAR(deeper.entering * square, 4 * circle, 0.1F * circle);
}

TEST(ReachBehind, AgreesWithANaiveReference) {
  const test::SampledShape sampled = headed_screw();
  for (std::uint64_t trial = 0; trial < 30; ++trial) {
    SCOPED_TRACE(trial);
    test::Random random(trial);
    const Pose pose = random.motion();
    const Vector3f normal = random.direction();
    const Plane plane{normal, normal.dot(pose.translation()) + random.uniform(-0.03F, 0.03F), 1, 0};
    const PlaneReach reach = reach_behind(sampled.view(), pose, plane, kOnPlane);
    double depth = -std::numeric_limits<double>::infinity(), entering = 0;
    const Eigen::Isometry3d exact(pose.cast<double>().matrix());
    for (std::size_t i = 0; i < sampled.points.size(); ++i) {
      const Eigen::Vector3d p = exact * Vector3f(sampled.points[i]).cast<double>();
      const Eigen::Vector3d n = exact.linear() * Vector3f(sampled.normals[i]).cast<double>();
      const double behind = static_cast<double>(plane.offset) - normal.cast<double>().dot(p);
      depth = std::max(depth, behind);
      if (behind > static_cast<double>(kOnPlane))
        entering += std::max(0.0, -normal.cast<double>().dot(n));
    }
    EXPECT_NEAR(reach.depth, depth, 1e-5);
    EXPECT_NEAR(reach.entering, entering, 3 + 0.002 * entering) << "rounding moves a few samples";
    EXPECT_NEAR(plane.offset - normal.dot(pose * reach.deepest), depth, 1e-5);
  }
}

// A wall whose left half is 2 cm farther away than its right half.
TEST(CountSeenBehind, CountsTheSamplesOnPixelsBehindThePlane) {
  const test::SampledShape sampled = headed_screw();
  RangeImage image;
  image.geometry = {test::pose_of({0, 0, 0}, {0, 0, 1}), 400, 400, 39.5F, 29.5F, 80, 60};
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) image.depth.push_back(u < 40 ? 1.02F : 1.0F);
  }
  const Plane right{Vector3f(0, 0, -1), 0, 1, 0};  // in the scene's frame, which is 1 m away
  const auto count = [&](float shift, float distance, std::size_t num_samples = 1 << 20) {
    return count_seen_behind(image, sampled.view(), num_samples,
                             test::pose_of({0, 0, 0}, {shift, 0, 0}), right, distance);
  };
  EXPECT_EQ(count(-0.03F, 0.01F), sampled.points.size());
  EXPECT_EQ(count(-0.03F, 0.01F, 300), 300U);
  EXPECT_EQ(count(-0.03F, 0.03F), 0U) << "what is seen is nearer";
  EXPECT_EQ(count(0.03F, 0.01F), 0U);
  EXPECT_NEAR(static_cast<double>(count(0, 0.01F)),
              0.5 * static_cast<double>(sampled.points.size()),
              0.1 * static_cast<double>(sampled.points.size()));
  EXPECT_EQ(count(1, 0.01F), 0U) << "outside the image";
  image.depth.assign(image.depth.size(), 0);
  EXPECT_EQ(count(-0.03F, 0.01F), 0U) << "nothing is measured";
}

TEST(IsSurrounded, NeedsThePlaneOnBothSidesAlongEachLine) {
  RangeImage image;
  image.geometry = {Pose::Identity(), 100, 100, 19.5F, 14.5F, 40, 30};
  const auto show = [&](auto&& on_plane) {
    image.near_plane.assign(1200, 0);
    for (int v = 0; v < 30; ++v) {
      for (int u = 0; u < 40; ++u)
        image.near_plane[static_cast<std::size_t>(40 * v + u)] = on_plane(u, v) ? 2 : 0;
    }
  };
  const auto surrounded = [&](int u, int v) {
    return is_surrounded(
        image, 2,
        {(static_cast<float>(u) - 19.5F) / 100, (static_cast<float>(v) - 14.5F) / 100, 1});
  };
  // An object hides the middle of a table.
  show([](int u, int v) { return u < 10 || u > 30 || v < 8 || v > 22; });
  EXPECT_TRUE(surrounded(20, 15));
  EXPECT_TRUE(surrounded(5, 5)) << "on the plane itself";
  EXPECT_FALSE(is_surrounded(image, 1, {0, 0, 1}));
  EXPECT_FALSE(is_surrounded(image, 2, {1, 0, 1})) << "outside the image";
  // Beyond the edge of a table, and in a gap between two.
  show([](int u, int) { return u < 10; });
  EXPECT_FALSE(surrounded(20, 15));
  show([](int u, int v) { return 2 * u + 5 * v < 70; });
  EXPECT_FALSE(surrounded(12, 12)) << "the edge is aslant: each line meets the table on one side";
  show([](int u, int) { return u < 10 || u > 30; });
  EXPECT_FALSE(surrounded(20, 15));
}

}  // namespace
}  // namespace trivet::kernels
