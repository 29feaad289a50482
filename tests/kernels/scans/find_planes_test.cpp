#include "kernels/scans/find_planes.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Oriented points, each a sample of a surface, and the plane on which each was generated.
struct Surfaces {
  Points points;
  Normals normals;
  std::vector<float> areas;
  std::vector<int> made_on;

  void add(const Vector3f& p, const Vector3f& n, float area, int plane) {
    points.push_back(p);
    normals.push_back(n);
    areas.push_back(area);
    made_on.push_back(plane);
  }
  /// A rectangle of these half sides. Its normal is +z before the motion; positions and normals are
  /// noisy.
  void add_rectangle(Random& random, std::size_t n, const Pose& T, float a, float b, float noise,
                     int plane) {
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3f p(random.uniform(-a, a), random.uniform(-b, b), random.normal(noise));
      const Vector3f normal(random.normal(0.05F), random.normal(0.05F), 1);
      add(T * p, T.linear() * normal.normalized(), 4 * a * b / static_cast<float>(n), plane);
    }
  }
  void add_clutter(Random& random, std::size_t n, float area) {
    for (std::size_t i = 0; i < n; ++i) {
      add({random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)}, random.direction(),
          area, 0);
    }
  }
};

constexpr float kTolerance = 0.03F;
PlaneOptions options_of(float min_area) {
  PlaneOptions options;
  options.tolerance = kTolerance;
  options.min_area = min_area;
  return options;
}

/// A table of 4 x 3 and a wall of 2 x 2 with noise and clutter, in random order.
struct TableAndWall {
  explicit TableAndWall(std::uint64_t trial) {
    Random random(trial);
    T_table = random.motion();
    T_wall = T_table * Eigen::AngleAxisf(1.3F, Vector3f::UnitX());
    T_wall.pretranslate(random.direction());
    Surfaces in_order;
    in_order.add_rectangle(random, 2000, T_table, 2, 1.5F, 0.008F, 1);
    in_order.add_rectangle(random, 700, T_wall, 1, 1, 0.008F, 2);
    in_order.add_clutter(random, 1000, 0.004F);
    for (const std::uint32_t i : random.permutation(3700)) {
      surfaces.add(in_order.points[i], in_order.normals[i], in_order.areas[i], in_order.made_on[i]);
    }
  }
  Pose T_table, T_wall;
  Surfaces surfaces;
};

TEST(FindPlanes, FindsTwoPlanesAmongNoiseAndClutter) {
  for (std::uint64_t trial = 0; trial < 3; ++trial) {
    const TableAndWall scene(trial);
    const Surfaces& s = scene.surfaces;
    const auto planes = find_planes(s.points, s.normals, s.areas, options_of(1));
    ASSERT_EQ(planes.size(), 2U) << trial;
    EXPECT_NEAR(planes[0].area, 12, 0.5);
    EXPECT_NEAR(planes[1].area, 4, 0.3);
    int k = 0;
    for (const Pose& T : {scene.T_table, scene.T_wall}) {
      const Vector3f normal = T.linear().col(2);
      const Plane& plane = planes[static_cast<std::size_t>(k++)];
      EXPECT_NEAR(plane.normal.norm(), 1, 1e-5);
      EXPECT_GT(plane.normal.dot(normal), std::cos(0.003F)) << "and to the points' side";
      EXPECT_NEAR(plane.offset, normal.dot(T.translation()), 0.005);
    }
  }
}

TEST(FindPlanes, LeavesOutPlanesBelowTheLeastAreaAndBeyondTheirNumber) {
  const TableAndWall scene(0);
  const Surfaces& s = scene.surfaces;
  EXPECT_EQ(find_planes(s.points, s.normals, s.areas, options_of(5)).size(), 1U);
  EXPECT_EQ(find_planes(s.points, s.normals, s.areas, options_of(15)).size(), 0U);
  PlaneOptions one = options_of(1);
  one.max_planes = 1;
  const auto planes = find_planes(s.points, s.normals, s.areas, one);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_GT(planes[0].area, 10) << "the largest";
}

TEST(FindPlanes, DistinguishesTheTwoSidesOfASheet) {
  Random random;
  Surfaces s;
  s.add_rectangle(random, 1000, Pose::Identity(), 1, 1, 0, 1);
  const Pose over(Eigen::AngleAxisf(3.1415927F, Vector3f::UnitX()));
  s.add_rectangle(random, 500, over, 1, 0.5F, 0, 2);
  const auto planes = find_planes(s.points, s.normals, s.areas, options_of(1));
  ASSERT_EQ(planes.size(), 2U);
  EXPECT_GT(planes[0].normal.z(), 0.999F);
  EXPECT_LT(planes[1].normal.z(), -0.999F);
  EXPECT_NEAR(planes[0].area, 4, 1e-3);
  EXPECT_NEAR(planes[1].area, 2, 1e-3);
}

// The sheet's face is nearer to the table than the tolerance that finds planes in noise.
TEST(FindPlanes, TellsASheetFromTheTableThatItLiesOn) {
  Random random;
  Surfaces s;
  constexpr float kScatter = 0.001F, kSheet = 0.02F;
  s.add_rectangle(random, 4000, Pose::Identity(), 2, 1.5F, kScatter, 1);
  Pose on_top = Pose::Identity();
  on_top.translation() = Vector3f(0.8F, 0.2F, kSheet);
  s.add_rectangle(random, 2000, on_top, 1, 1, kScatter, 0);
  PlaneOptions options = options_of(1);
  options.noise = kScatter;
  const auto planes = find_planes(s.points, s.normals, s.areas, options);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].offset, 0, 0.2F * kScatter) << "the sheet does not lift it";
  EXPECT_GT(planes[0].thickness, 4 * kScatter);
  EXPECT_LT(planes[0].thickness, 7 * kScatter);
  std::vector<std::uint8_t> labels(s.points.size());
  label_planes(s.points, planes, labels);
  int wrong = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) wrong += labels[i] != s.made_on[i];
  EXPECT_LE(wrong, 2);
}

TEST(FindPlanes, GivesTheSamePlanesEveryTime) {
  const TableAndWall scene(0);
  const Surfaces& s = scene.surfaces;
  const auto a = find_planes(s.points, s.normals, s.areas, options_of(1));
  const auto b = find_planes(s.points, s.normals, s.areas, options_of(1));
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].normal, b[k].normal);
    EXPECT_EQ(a[k].offset, b[k].offset);
    EXPECT_EQ(a[k].area, b[k].area);
  }
}

TEST(FindPlanes, IgnoresPointsWithoutANormal) {
  Random random;
  Surfaces s;
  s.add_rectangle(random, 500, Pose::Identity(), 1, 1, 0, 1);
  for (std::size_t i = 0; i < 500; i += 2) s.normals.set(i, Vector3f::Constant(kNaN));
  const auto planes = find_planes(s.points, s.normals, s.areas, options_of(1));
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_NEAR(planes[0].area, 2, 1e-3);
  for (std::size_t i = 0; i < 500; ++i) s.normals.set(i, Vector3f::Constant(kNaN));
  EXPECT_TRUE(find_planes(s.points, s.normals, s.areas, options_of(1)).empty());
}

TEST(FindPlanes, FindsNothingInNoPointsAndInClutter) {
  EXPECT_TRUE(find_planes({}, {}, {}, options_of(1)).empty());
  Random random;
  Surfaces s;
  s.add_clutter(random, 2000, 0.004F);
  EXPECT_TRUE(find_planes(s.points, s.normals, s.areas, options_of(1)).empty());
}

TEST(LabelPlanes, NumbersPointsByThePlaneTheyLieOn) {
  const TableAndWall scene(0);
  const Surfaces& s = scene.surfaces;
  const auto planes = find_planes(s.points, s.normals, s.areas, options_of(1));
  std::vector<std::uint8_t> labels(s.points.size(), 99);
  label_planes(s.points, s.normals, planes, 0.35F, labels);
  int wrong = 0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    std::uint8_t expected = 0;
    for (std::size_t k = planes.size(); k-- > 0;) {
      const double height = planes[k].normal.dot(s.points[i]) - planes[k].offset;
      const double cosine = planes[k].normal.dot(s.normals[i]);
      if (std::abs(height) <= static_cast<double>(planes[k].thickness) &&
          cosine >= std::cos(0.35)) {
        expected = static_cast<std::uint8_t>(k + 1);
      }
    }
    EXPECT_EQ(labels[i], expected);
    wrong += labels[i] != s.made_on[i];
  }
  EXPECT_LT(wrong, 100);  // clutter on a plane, and the crossing of the two
}

TEST(LabelPlanes, ChoosesTheFirstOfPlanesAndNoneWithoutAPointOrANormal) {
  Points points;
  Normals normals;
  points.push_back({0, 0, kNaN});
  points.push_back({0, 0, 0});
  points.push_back({0, 0, 0});
  normals.push_back({0, 0, 1});
  normals.push_back(Vector3f::Constant(kNaN));
  normals.push_back({0, 0, 1});
  const std::vector<Plane> planes(2, Plane{Vector3f(0, 0, 1), 0, 1, kTolerance});
  std::vector<std::uint8_t> labels(3, 99);
  label_planes(points, normals, planes, 0.35F, labels);
  EXPECT_EQ(labels, (std::vector<std::uint8_t>{0, 0, 1}));
  label_planes(points, planes, labels);
  EXPECT_EQ(labels, (std::vector<std::uint8_t>{0, 1, 1})) << "by position alone";
}

}  // namespace
}  // namespace trivet::kernels
