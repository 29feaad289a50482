#include "kernels/meshing/triangulate_greedy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <vector>

#include "support/random.hpp"
#include "support/reference_mesh.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::Random;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

struct Oriented {
  Points points;
  Normals normals;
  float spacing = 0;  // square root of the area per point

  void add(const Vector3f& point, const Vector3f& normal) {
    points.push_back(point);
    normals.push_back(normal);
  }
};

/// Random points on the unit sphere, moved along their normals by noise in units of the spacing.
Oriented sphere(std::size_t n, float noise = 0) {
  Random random(n);
  Oriented cloud;
  cloud.spacing = std::sqrt(4 * std::numbers::pi_v<float> / static_cast<float>(n));
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3f d = random.direction();
    cloud.add((1 + random.normal(1) * noise * cloud.spacing) * d, d);
  }
  return cloud;
}

/// Random points in the unit square at z = 0.
Oriented square(std::size_t n, std::uint64_t test_case = 0) {
  Random random(test_case);
  Oriented cloud;
  cloud.spacing = 1 / std::sqrt(static_cast<float>(n));
  for (std::size_t i = 0; i < n; ++i)
    cloud.add({random.uniform(0, 1), random.uniform(0, 1), 0}, Vector3f::UnitZ());
  return cloud;
}

Oriented lattice(int side) {
  Oriented cloud;
  cloud.spacing = 1;
  for (int i = 0; i < side * side; ++i)
    cloud.add({static_cast<float>(i % side), static_cast<float>(i / side), 0}, Vector3f::UnitZ());
  return cloud;
}

/// A gently curved sheet with exact normals.
Oriented sheet(std::size_t n) {
  Random random;
  Oriented cloud;
  cloud.points = random.surface(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3f p = cloud.points[i];
    cloud.normals.push_back(Vector3f(-0.4F * std::cos(2 * p.x()) * std::cos(p.y()),
                                     0.2F * std::sin(2 * p.x()) * std::sin(p.y()), 1)
                                .normalized());
  }
  cloud.spacing = 2 / std::sqrt(static_cast<float>(n));
  return cloud;
}

Triangles triangulate(const Oriented& cloud, const GreedyOptions& options = {}) {
  return *triangulate_greedy(cloud.points, cloud.normals, options);
}

using Corners = std::array<std::uint32_t, 3>;

/// Triangles with their winding, each from its lowest corner.
std::set<Corners> as_set(const Triangles& triangles) {
  std::set<Corners> all;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    Corners c{triangles.a[t], triangles.b[t], triangles.c[t]};
    std::ranges::rotate(c, std::ranges::min_element(c));
    EXPECT_TRUE(all.insert(c).second) << "a triangle twice";
  }
  return all;
}

std::size_t num_used(const Triangles& triangles) {
  std::set<std::uint32_t> used;
  for (const auto* corners : {&triangles.a, &triangles.b, &triangles.c})
    used.insert(corners->begin(), corners->end());
  return used.size();
}

double area(const Oriented& cloud, const Triangles& triangles) {
  double sum = 0;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3f a = cloud.points[triangles.a[t]];
    const Vector3f n = (cloud.points[triangles.b[t]] - a).cross(cloud.points[triangles.c[t]] - a);
    sum += static_cast<double>(n.norm()) / 2;
  }
  return sum;
}

double longest_edge(const Oriented& cloud, const Triangles& triangles) {
  double longest = 0;
  for (const Corners& c : as_set(triangles)) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3f edge = cloud.points[c[k]] - cloud.points[c[(k + 1) % 3]];
      longest = std::max(longest, static_cast<double>(edge.norm()));
    }
  }
  return longest;
}

/// Whether all triangles face in the direction of the normals of their corners.
testing::AssertionResult agree_with_normals(const Oriented& cloud, const Triangles& triangles) {
  for (const Corners& c : as_set(triangles)) {
    const Vector3f a = cloud.points[c[0]];
    const Vector3f n = (cloud.points[c[1]] - a).cross(cloud.points[c[2]] - a);
    for (const std::uint32_t v : c) {
      if (!(n.dot(cloud.normals[v]) > 0))
        return testing::AssertionFailure() << "triangle of " << c[0] << " at " << v;
    }
  }
  return testing::AssertionSuccess();
}

double share(std::size_t part, std::size_t all) {
  return static_cast<double>(part) / static_cast<double>(all);
}

TEST(TriangulateGreedy, CoversALatticeWithTwoTrianglesASquare) {
  const Oriented cloud = lattice(20);
  const Triangles triangles = triangulate(cloud);
  EXPECT_EQ(triangles.size(), 2U * 19 * 19);
  EXPECT_EQ(area(cloud, triangles), 19.0 * 19);
  EXPECT_EQ(reference::count_open_edges(triangles), 4U * 19);
  EXPECT_TRUE(agree_with_normals(cloud, triangles));
}

TEST(TriangulateGreedy, CoversEveryPlaceOfASquareOnce) {
  const Oriented cloud = square(1500);
  const Triangles triangles = triangulate(cloud);
  EXPECT_TRUE(agree_with_normals(cloud, triangles));
  EXPECT_EQ(num_used(triangles), cloud.points.size());
  Random random(1);
  std::size_t num_open = 0;
  constexpr std::size_t kPlaces = 5000;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const float margin = 2 * cloud.spacing;  // the border is ragged
    const Vector3f p(random.uniform(margin, 1 - margin), random.uniform(margin, 1 - margin), 0);
    std::size_t num_covering = 0;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      const Vector3f a = cloud.points[triangles.a[t]], b = cloud.points[triangles.b[t]],
                     c = cloud.points[triangles.c[t]];
      const auto side = [&](const Vector3f& from, const Vector3f& to) {
        return (to - from).cross(p - from).z();
      };
      num_covering += side(a, b) > 1e-9F && side(b, c) > 1e-9F && side(c, a) > 1e-9F;
    }
    EXPECT_LE(num_covering, 1U) << "triangles overlap at " << p.transpose();
    num_open += num_covering == 0;
  }
  EXPECT_LT(share(num_open, kPlaces), 0.01);
}

/// Whether an edge of a triangle in the plane has another triangle on its outer side.
bool is_beside(const std::array<Vector3f, 3>& one, const std::array<Vector3f, 3>& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d a = one[k].cast<double>(), b = one[(k + 1) % 3].cast<double>();
    if (std::ranges::all_of(other, [&](const Vector3f& p) {
          return (b - a).cross(p.cast<double>() - a).z() <= 1e-9;
        })) {
      return true;
    }
  }
  return false;
}

TEST(TriangulateGreedy, OverlapsNowhereInThePlane) {
  for (std::uint64_t trial = 0; trial < 100; ++trial) {
    // Points with density increasing to the left.
    Oriented cloud = square(200, trial);
    for (float& x : cloud.points.span().x) x = x * x * x;
    std::vector<std::array<Vector3f, 3>> all;
    for (const Corners& c : as_set(triangulate(cloud)))
      all.push_back({cloud.points[c[0]], cloud.points[c[1]], cloud.points[c[2]]});
    std::size_t num_overlaps = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        num_overlaps += !is_beside(all[i], all[j]) && !is_beside(all[j], all[i]);
    }
    EXPECT_EQ(num_overlaps, 0U) << "in trial " << trial;
  }
}

TEST(TriangulateGreedy, ClosesSpheresOfRandomPointsButForFewEdges) {
  for (const std::size_t n : {1000U, 4000U}) {
    SCOPED_TRACE(n);
    const Oriented cloud = sphere(n);
    const Triangles triangles = triangulate(cloud);
    EXPECT_GE(share(num_used(triangles), n), 0.99);
    EXPECT_GT(share(triangles.size(), 2 * n - 4), 0.98);
    EXPECT_LT(share(reference::count_open_edges(triangles), 3 * triangles.size() / 2), 0.015);
    EXPECT_TRUE(agree_with_normals(cloud, triangles));
    EXPECT_NEAR(area(cloud, triangles) / (4 * std::numbers::pi), 1,
                20 / static_cast<double>(n) + 0.01);
  }
}

TEST(TriangulateGreedy, BearsNoise) {
  const Oriented cloud = sphere(4000, 0.4F);
  const Triangles triangles = triangulate(cloud);
  EXPECT_GT(share(num_used(triangles), 4000), 0.96);
  EXPECT_LT(share(reference::count_open_edges(triangles), 3 * triangles.size() / 2), 0.02);
  EXPECT_TRUE(agree_with_normals(cloud, triangles));
}

TEST(TriangulateGreedy, StaysAManifoldOnRandomNormals) {
  // Random input without a surface: points in a ball with random normals.
  Random random;
  Oriented cloud;
  for (int i = 0; i < 2000; ++i)
    cloud.add(random.direction() * random.uniform(0, 1), random.direction());
  const Triangles triangles = triangulate(cloud, {.max_normal_angle_deg = 90});
  EXPECT_GT(triangles.size(), 100U);
  reference::count_open_edges(triangles);  // fails where a side of an edge has two triangles
  EXPECT_TRUE(agree_with_normals(cloud, triangles));

  // Many points that lie in one direction from another point.
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    cloud.points.set(i, (5 * cloud.points[i]).array().round().matrix());
  reference::count_open_edges(triangulate(cloud, {.max_normal_angle_deg = 90}));
}

TEST(TriangulateGreedy, FollowsTheDensityOfThePoints) {
  // The left half has 16 times the density.
  Oriented cloud;
  for (const auto& [n, left] : {std::pair{1600U, 0.0F}, {100U, 0.5F}}) {
    const Oriented half = square(n, n);
    for (std::size_t i = 0; i < n; ++i)
      cloud.add({left + half.points[i].x() / 2, half.points[i].y(), 0}, Vector3f::UnitZ());
  }
  const Triangles triangles = triangulate(cloud);
  EXPECT_GT(share(num_used(triangles), cloud.points.size()), 0.98);
  EXPECT_GT(area(cloud, triangles), 0.85) << "all but the ragged border";
}

TEST(TriangulateGreedy, LeavesHolesOpenThatAreLargerThanTheReach) {
  Oriented cloud;
  const Oriented whole = square(3000);
  for (std::size_t i = 0; i < 3000; ++i) {
    if ((whole.points[i] - Vector3f(0.5F, 0.5F, 0)).norm() > 10 * whole.spacing)
      cloud.add(whole.points[i], Vector3f::UnitZ());
  }
  const Triangles triangles = triangulate(cloud);
  const double hole = std::numbers::pi * std::pow(10 * whole.spacing, 2);
  EXPECT_LT(area(cloud, triangles), 1 - 0.8 * hole);
  EXPECT_GT(area(cloud, triangles), 0.95 - hole);
  EXPECT_LT(longest_edge(cloud, triangles), 5 * whole.spacing);
}

TEST(TriangulateGreedy, KeepsParallelSheetsApart) {
  for (const bool same_side : {true, false}) {
    // Two sheets, two spacings apart if both face up, else nearly coincident.
    const float height = (same_side ? 2 : 0.05F) * square(1500).spacing;
    Oriented cloud;
    const Oriented lower = square(1500, 1), upper = square(1500, 2);
    for (std::size_t i = 0; i < 1500; ++i) {
      cloud.add(lower.points[i], Vector3f(0, 0, same_side ? 1 : -1));
      cloud.add(upper.points[i] + Vector3f(0, 0, height), Vector3f::UnitZ());
    }
    const Triangles triangles = triangulate(cloud);
    EXPECT_GT(area(cloud, triangles), 2 * 0.95);
    for (const Corners& c : as_set(triangles))
      EXPECT_TRUE(c[0] % 2 == c[1] % 2 && c[1] % 2 == c[2] % 2) << "joins the sheets";
  }
}

TEST(TriangulateGreedy, LeavesPointsOutThatAreNotFiniteWithoutANormalOrRepeated) {
  const Oriented clean = sheet(500);
  Oriented spoilt;
  std::vector<std::uint32_t> of_clean;  // indices of its points in the spoilt cloud
  Random random(1);
  for (std::size_t i = 0; i < 500; ++i) {
    const Vector3f p = clean.points[i], n = clean.normals[i];
    of_clean.push_back(static_cast<std::uint32_t>(spoilt.points.size()));
    spoilt.add(p, random.uniform(0.1F, 10) * n);  // of any length
    switch (i % 5) {
      case 0:
        spoilt.add({kNaN, p.y(), p.z()}, n);
        break;
      case 1:
        spoilt.add(p + Vector3f(0.01F, 0, 0), Vector3f::Constant(kNaN));
        break;
      case 2:
        spoilt.add(p + Vector3f(0.01F, 0, 0), Vector3f::Zero());
        break;
      case 3:
        spoilt.add(p, n);
        break;
      default:
        spoilt.add(Vector3f::Constant(std::numeric_limits<float>::infinity()), n);
        break;
    }
  }
  std::set<Corners> expected;
  for (const Corners& c : as_set(triangulate(clean)))
    expected.insert({of_clean[c[0]], of_clean[c[1]], of_clean[c[2]]});
  EXPECT_GT(expected.size(), 800U);
  EXPECT_EQ(as_set(triangulate(spoilt)), expected);
}

TEST(TriangulateGreedy, BearsPointsStraightAboveOthers) {
  Oriented cloud = lattice(20);
  for (int i = 0; i < 20; ++i)
    cloud.add({static_cast<float>(i), static_cast<float>(i), 0.25F}, Vector3f::UnitZ());
  const Triangles triangles = triangulate(cloud);
  EXPECT_NEAR(area(cloud, triangles), 19.0 * 19, 19);
  reference::count_open_edges(triangles);  // fails where a side of an edge has two triangles
}

TEST(TriangulateGreedy, ReachesNoOutliers) {
  Oriented cloud = square(1000);
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    cloud.add({random.uniform(-3, 4), random.uniform(2, 5), 0}, Vector3f::UnitZ());
  }
  EXPECT_LT(longest_edge(cloud, triangulate(cloud, {.radius = 0.3F})), 0.3);
  for (const Corners& c : as_set(triangulate(cloud))) {
    const auto num_far = std::ranges::count_if(c, [](std::uint32_t v) { return v >= 1000; });
    EXPECT_TRUE(num_far == 0 || num_far == 3) << "joins an outlier";
  }
}

TEST(TriangulateGreedy, AcceptsAFewPoints) {
  const float h = std::sqrt(3.0F) / 2;
  Oriented cloud;
  for (const Vector3f& p : {Vector3f(0, 0, 0), Vector3f(1, 0, 0), Vector3f(0.5F, h, 0)}) {
    EXPECT_TRUE(triangulate(cloud).empty());
    cloud.add(p, Vector3f::UnitZ());
  }
  EXPECT_EQ(as_set(triangulate(cloud)), (std::set<Corners>{{0, 1, 2}}));
  for (int i = 0; i < 3; ++i) cloud.normals.set(static_cast<std::size_t>(i), -Vector3f::UnitZ());
  EXPECT_EQ(as_set(triangulate(cloud)), (std::set<Corners>{{0, 2, 1}}));

  Oriented line;
  for (int i = 0; i < 30; ++i) line.add({static_cast<float>(i), 0, 0}, Vector3f::UnitZ());
  EXPECT_TRUE(triangulate(line).empty());
  Oriented one_place;
  for (int i = 0; i < 30; ++i) one_place.add({1, 2, 3}, Vector3f::UnitZ());
  EXPECT_TRUE(triangulate(one_place).empty());
}

TEST(TriangulateGreedy, MovesWithTheCloud) {
  // The axes are swapped and the scale is a power of two: only the arithmetic rounds, not the
  // coordinates.
  const Oriented cloud = sheet(2000);
  Eigen::Matrix3f turn;
  turn << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  Oriented moved;
  moved.points = test::transformed(cloud.points, 4 * turn, Vector3f::Zero());
  moved.normals = test::transformed(cloud.normals, turn, Vector3f::Zero());
  EXPECT_EQ(as_set(triangulate(moved)), as_set(triangulate(cloud)));

  // For any other motion, rounding may choose between two diagonals of four nearly concyclic
  // points.
  Random random(1);
  const Pose motion = random.motion();
  moved.points = test::transformed(cloud.points, motion.linear(), motion.translation());
  moved.normals = test::transformed(cloud.normals, motion.linear(), Vector3f::Zero());
  std::vector<Corners> common;
  const std::set<Corners> here = as_set(triangulate(cloud)), there = as_set(triangulate(moved));
  std::ranges::set_intersection(here, there, std::back_inserter(common));
  EXPECT_GT(share(common.size(), here.size()), 0.995);
}

TEST(TriangulateGreedy, KeepsItsLimits) {
  const Oriented cloud = sheet(2000);
  EXPECT_LE(longest_edge(cloud, triangulate(cloud, {.radius = 1.5F * cloud.spacing})),
            1.5F * cloud.spacing);
  EXPECT_LT(triangulate(cloud, {.mu = 1.5F}).size(), triangulate(cloud).size());
  EXPECT_GT(triangulate(cloud, {.max_neighbors = 8}).size(), triangulate(cloud).size() / 2);

  // Two faces at a right angle stay separate, as the normals of the corners require.
  Oriented edge;
  const Oriented face = square(600);
  for (std::size_t i = 0; i < 600; ++i) {
    const Vector3f p = face.points[i];
    edge.add({p.x(), p.y(), 0}, Vector3f::UnitZ());
    edge.add({0, p.y(), -p.x()}, -Vector3f::UnitX());
  }
  for (const Corners& c : as_set(triangulate(edge)))
    EXPECT_TRUE(c[0] % 2 == c[1] % 2 && c[1] % 2 == c[2] % 2);
}

TEST(TriangulateGreedy, LeavesNarrowTrianglesOutWhenAskedTo) {
  const Oriented cloud = square(3000);
  const auto num_narrow = [&](const Triangles& triangles) {
    std::size_t num = 0;
    for (const Corners& c : as_set(triangles)) {
      bool narrow = false;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3f a = cloud.points[c[(k + 1) % 3]] - cloud.points[c[k]],
                       b = cloud.points[c[(k + 2) % 3]] - cloud.points[c[k]];
        narrow |= std::atan2(a.cross(b).norm(), a.dot(b)) < 0.1744F;  // 10 degrees, rounded down
      }
      num += narrow;
    }
    return num;
  };
  const Triangles all = triangulate(cloud), wide = triangulate(cloud, {.min_angle_deg = 10});
  EXPECT_GT(share(num_narrow(all), all.size()), 0.03);
  EXPECT_EQ(num_narrow(wide), 0U);
  EXPECT_GT(share(wide.size(), all.size()), 0.85);
}

}  // namespace
}  // namespace trivet::kernels
