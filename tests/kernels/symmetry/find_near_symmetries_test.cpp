#include "kernels/symmetry/find_near_symmetries.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <numbers>
#include <string>

#include "kernels/common/pose_math.hpp"
#include "kernels/surfaces/diameter.hpp"
#include "kernels/symmetry/find_symmetry.hpp"
#include "storage/datasets/manifest.hpp"
#include "storage/formats/read_cloud.hpp"
#include "support/random.hpp"
#include "support/sampled_shape.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::box;
using test::circle;
using test::prism;
using test::SampledShape;
using test::Shape;

constexpr float kDegree = std::numbers::pi_v<float> / 180;

/// A shape, its known symmetry, and its near symmetries.
struct Found {
  SampledShape surface;
  Symmetry symmetry;
  std::vector<Pose> motions;
  std::optional<Symmetry::Axis> axis;

  explicit Found(const Shape& shape, std::uint64_t seed = 1)
      : surface(test::sample_shape(shape.vertices, shape.triangles, seed)) {
    surface.diameter = find_diameter(shape.vertices);
    const SampledSurface sampled(surface.points, surface.normals, surface.diameter);
    const TurnScreen screen(sampled);
    symmetry = find_symmetry(sampled, screen);
    NearSymmetries near = find_near_symmetries(surface.view(), sampled, screen, symmetry);
    motions = std::move(near.motions);
    axis = near.axis;
  }

  PoseDistance distance(const Pose& a, const Pose& b) const {
    return pose_distance(a, b, symmetry, surface.view().center);
  }
  bool has(const Pose& motion, float angle = 10 * kDegree) const {
    return std::ranges::any_of(
        motions, [&](const Pose& other) { return distance(motion, other).rotation_rad < angle; });
  }
};

Pose turn(const Vector3f& axis, float angle, const Vector3f& point = {0, 0, 0}) {
  return small_motion(axis * angle, Vector3f::Zero(), point);
}

Shape bolt() {
  Shape shape = prism(60, circle(0.25), -1, 0.8);
  return shape.join(prism(60, circle(0.3), 0.8, 1));
}
Shape cube_with_stub() {
  Shape shape = box({-0.5F, -0.5F, -0.5F}, {0.5F, 0.5F, 0.5F});
  return shape.join(box({-0.1F, -0.1F, 0.5F}, {0.1F, 0.1F, 0.6F}));
}
Shape beaker() {  // with a small lip; tapered, so that its ends differ
  Shape shape = prism(100, circle(1), 0, 2, 0, 0.4);
  return shape.join(box({0.3F, -0.1F, 1.6F}, {0.8F, 0.1F, 1.8F}));
}
Shape tripod() {  // one leg is shorter
  Shape shape = prism(60, circle(0.3), 0, 0.4);
  for (int k = 0; k < 3; ++k) {
    shape.join(box({0.2F, -0.1F, -0.8F}, {k == 0 ? 0.8F : 1.0F, 0.1F, 0.2F})
                   .moved(turn({0, 0, 1}, static_cast<float>(k) * 120 * kDegree)));
  }
  return shape;
}
Shape horn() {  // bent, twisted, thicker towards one end
  Shape shape;
  for (int k = 0; k < 40; ++k) {
    const float s = static_cast<float>(k) / 40, radius = 0.08F + 0.2F * s;
    const Vector3f place(std::cos(4 * s) * (1 - 0.5F * s), std::sin(4 * s) * (1 - 0.3F * s),
                         1.5F * s * s);
    shape.join(
        test::ellipsoid({radius, radius, radius}, 12).moved(Pose(Eigen::Translation3f(place))));
  }
  return shape;
}

TEST(FindNearSymmetries, TurnsABoltEndForEndAndNothingElse) {
  const Found found(bolt());
  ASSERT_TRUE(found.symmetry.axis);
  ASSERT_EQ(found.motions.size(), 1U);
  EXPECT_LT(found.motions[0].linear()(2, 2), std::cos(175 * kDegree));
  EXPECT_LT((found.motions[0] * found.surface.view().center).head<2>().norm(), 0.05F);
}

TEST(FindNearSymmetries, PutsTheStubOfACubeOnAnyFace) {
  const Found found(cube_with_stub());
  EXPECT_EQ(found.symmetry.poses.size(), 3U);
  EXPECT_EQ(found.motions.size(), 5U) << "turns about the stub are symmetries";
  for (const Vector3f& axis : {Vector3f(1, 0, 0), Vector3f(0, 1, 0)}) {
    for (const float quarters : {1.0F, 2.0F, 3.0F})
      EXPECT_TRUE(found.has(turn(axis, quarters * 90 * kDegree))) << axis << quarters;
  }
}

TEST(FindNearSymmetries, TurnsABoxOfAlmostEqualSides) {
  const Found found(box({-0.5F, -0.485F, -0.3F}, {0.5F, 0.485F, 0.3F}));
  EXPECT_EQ(found.symmetry.poses.size(), 3U);
  ASSERT_FALSE(found.motions.empty());
  EXPECT_LT(found.distance(found.motions[0], turn({0, 0, 1}, 90 * kDegree)).rotation_rad, 0.02F);
  EXPECT_FALSE(found.axis);
}

TEST(FindNearSymmetries, FindsAnAxisOfNearRotationalSymmetry) {
  const Found found(beaker());
  EXPECT_TRUE(found.symmetry.trivial());
  ASSERT_TRUE(found.axis);
  EXPECT_GT(std::abs(found.axis->direction.z()), std::cos(1 * kDegree));
  EXPECT_LT(found.axis->point.head<2>().norm(), 0.01F);
  EXPECT_TRUE(found.motions.empty()) << "turns about the axis are no motions of their own";
  EXPECT_FALSE(Found(bolt()).axis) << "it is a symmetry";
  EXPECT_FALSE(Found(tripod()).axis);
  EXPECT_FALSE(Found(cube_with_stub()).axis);
}

TEST(FindNearSymmetries, FindsNoneOfWhatIsIrregularOrSymmetric) {
  EXPECT_TRUE(Found(horn()).motions.empty());
  EXPECT_TRUE(Found(test::ellipsoid({1, 1, 1})).motions.empty());
  EXPECT_TRUE(Found(box({0, 0, 0}, {1, 0.4F, 0.2F})).motions.empty());
  const SampledSurface nothing({}, {}, 1);
  EXPECT_TRUE(find_near_symmetries({}, nothing, TurnScreen(nothing), {}).motions.empty());
}

TEST(FindNearSymmetries, HoldsTheInverseOfEachAndKeepsThemApart) {
  const Found legs(tripod());
  EXPECT_TRUE(legs.has(turn({0, 0, 1}, 120 * kDegree)));
  EXPECT_TRUE(legs.has(turn({0, 0, 1}, 240 * kDegree)));
  for (const Shape& shape : {tripod(), cube_with_stub(), beaker(), bolt()}) {
    const Found found(shape);
    for (std::size_t i = 0; i < found.motions.size(); ++i) {
      const Pose& motion = found.motions[i];
      EXPECT_TRUE((motion.linear().transpose() * motion.linear()).isIdentity(1e-4F));
      EXPECT_TRUE(found.has(motion.inverse(), 20 * kDegree));
      EXPECT_GT(found.distance(Pose::Identity(), motion).rotation_rad, 19.9F * kDegree);
      for (std::size_t k = 0; k < i; ++k) {
        EXPECT_GT(found.distance(motion, found.motions[k]).rotation_rad, 19.9F * kDegree);
      }
    }
  }
}

TEST(FindNearSymmetries, MovesWithTheModel) {
  std::uint64_t number = 0;
  for (const Shape& shape : {bolt(), cube_with_stub(), tripod()}) {
    test::Random random(++number);
    const Pose moved = random.motion(3);
    const Found here(shape), there(shape.moved(moved), number);
    ASSERT_EQ(here.motions.size(), there.motions.size());
    for (const Pose& motion : here.motions)
      EXPECT_TRUE(there.has(moved * motion * moved.inverse()));
  }
}

TEST(FindNearSymmetries, GivesTheSameBitsTwice) {
  const Found a(tripod()), b(tripod());
  ASSERT_EQ(a.motions.size(), b.motions.size());
  for (std::size_t k = 0; k < a.motions.size(); ++k)
    EXPECT_EQ(a.motions[k].matrix(), b.motions[k].matrix());
}

TEST(FindNearSymmetries, TurnsRealThingsEndForEnd) {
  const std::map<std::string, bool> has_two_ends{{"banana", true},  {"drill", true},
                                                 {"mustard", true}, {"bunny", false},
                                                 {"spot", false},   {"fandisk", false}};
  const auto file = std::filesystem::path(TRIVET_DATA) / "clutter_table" / "manifest.json";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "development data is not at " << TRIVET_DATA;
  const auto manifest = read_manifest(file);
  ASSERT_TRUE(manifest) << manifest.error().message;
  std::size_t num_models = 0;
  for (const ManifestModel& model : manifest->models) {
    if (!has_two_ends.contains(model.name)) continue;
    const auto cloud = read_cloud(model.file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const Found found(Shape{cloud->points, cloud->triangles});
    ++num_models;
    ASSERT_EQ(!found.motions.empty(), has_two_ends.at(model.name)) << model.name;
    if (found.motions.empty()) continue;
    EXPECT_LE(found.motions.size(), 3U) << model.name;
    EXPECT_GT(rotation_angle(Eigen::Matrix3f::Identity(), found.motions[0].linear()), 170 * kDegree)
        << model.name;
  }
  EXPECT_EQ(num_models, has_two_ends.size());
}

}  // namespace
}  // namespace trivet::kernels
