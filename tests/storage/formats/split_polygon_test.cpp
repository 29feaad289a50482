#include "storage/formats/split_polygon.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "storage/common/stop.hpp"
#include "support/polygon_mesh.hpp"
#include "support/random.hpp"

namespace trivet {
namespace {

using formats::CornerTriangle;
using formats::split_polygon;
using formats::SplitScratch;
using test::bridged;
using test::Outline2d;

struct Split {
  Points points;
  std::vector<CornerTriangle> triangles;

  double area() const {
    double sum = 0;
    for (const CornerTriangle& t : triangles) {
      const Eigen::Vector3d a = points[t.a].cast<double>();
      sum += (points[t.b].cast<double>() - a).cross(points[t.c].cast<double>() - a).norm() / 2;
    }
    return sum;
  }
  bool is_fan() const {
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      if (triangles[i].a != 0 || triangles[i].b != i + 1 || triangles[i].c != i + 2) return false;
    }
    return true;
  }
};

Split split(Points points) {
  Split out{std::move(points), {}};
  std::vector<std::uint32_t> corners(out.points.size());
  std::iota(corners.begin(), corners.end(), 0U);
  out.triangles.resize(corners.size() - 2);
  SplitScratch scratch;
  std::uint64_t steps = 1'000'000'000;
  EXPECT_TRUE(split_polygon(out.points, corners, scratch, steps, out.triangles));
  return out;
}

Points place(const Outline2d& outline, const Pose& pose) {
  Points points;
  for (const Eigen::Vector2d& p : outline)
    points.push_back(pose * Eigen::Vector3d(p.x(), p.y(), 0).cast<float>());
  return points;
}

/// Whether the triangles' edges are the edges of the outline and inner edges in both directions.
testing::AssertionResult is_bounded_by_outline(const Split& split) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  const auto count = [&](std::uint32_t from, std::uint32_t to, int by) {
    if (from < to) edges[{from, to}] += by;
    if (from > to) edges[{to, from}] -= by;
  };
  const auto n = static_cast<std::uint32_t>(split.points.size());
  for (const CornerTriangle& t : split.triangles) {
    if (std::max({t.a, t.b, t.c}) >= n) return testing::AssertionFailure() << "no such corner";
    count(t.a, t.b, 1);
    count(t.b, t.c, 1);
    count(t.c, t.a, 1);
  }
  for (std::uint32_t i = 0; i < n; ++i) count(i, (i + 1) % n, -1);
  for (const auto& [edge, sum] : edges) {
    if (sum != 0)
      return testing::AssertionFailure() << "edge " << edge.first << " - " << edge.second;
  }
  return testing::AssertionSuccess();
}

Outline2d rectangle(double left, double bottom, double right, double top) {
  return {{left, bottom}, {right, bottom}, {right, top}, {left, top}};
}
Outline2d reversed(Outline2d outline) {
  std::reverse(outline.begin(), outline.end());
  return outline;
}
Outline2d shifted(Outline2d outline, std::size_t by) {
  std::rotate(outline.begin(), outline.begin() + static_cast<std::ptrdiff_t>(by % outline.size()),
              outline.end());
  return outline;
}

/// A staircase of random heights with integer coordinates: many collinear corners at equal heights.
Outline2d skyline(test::Random& random, int columns) {
  Outline2d outline{{0, 0}, {static_cast<double>(columns), 0}};
  for (int x = columns; x > 0; --x) {
    const double height = 1 + random.below(4);
    outline.emplace_back(x, height);
    outline.emplace_back(x - 1, height);
  }
  return outline;
}

/// Corners at random distances all around. The polygon is simple because the origin sees all
/// corners.
Outline2d star(test::Random& random, int corners) {
  Outline2d outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, radius = random.uniform(0.2F, 1);
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return outline;
}

/// A band wound into a spiral of several turns.
Outline2d spiral(int steps) {
  Outline2d outside, inside;
  for (int i = 0; i < steps; ++i) {
    const double angle = 0.3 * i, radius = 1 + 0.1 * i;
    const Eigen::Vector2d direction(std::cos(angle), std::sin(angle));
    outside.push_back((radius + 0.4) * direction);
    inside.push_back(radius * direction);
  }
  outside.insert(outside.end(), inside.rbegin(), inside.rend());
  return outside;
}

/// A plate with a row of holes. A bridge joins each hole to a corner of the lower edge below it.
Outline2d plate_with_row_of_holes(int holes, int corners_of_hole) {
  Outline2d outline{{0, 0}};
  for (int h = 0; h < holes; ++h) outline.emplace_back(2 * h + 1, 0);
  outline.insert(outline.end(), {{2.0 * holes, 0}, {2.0 * holes, 2}, {0, 2}});
  for (int h = 0; h < holes; ++h) {
    Outline2d hole;
    for (int i = 0; i < corners_of_hole; ++i) {
      const double angle = -2 * std::numbers::pi * i / corners_of_hole - std::numbers::pi / 2;
      hole.emplace_back(2 * h + 1 + 0.5 * std::cos(angle), 1 + 0.5 * std::sin(angle));
    }
    const auto at = std::ranges::find(outline, Eigen::Vector2d(2 * h + 1, 0));
    outline = bridged(outline, static_cast<std::size_t>(at - outline.begin()), hole);
  }
  return outline;
}

/// A plate with a row of square holes. Bridges join the first hole to the plate's corner and each
/// hole to the one before it: the outline passes above all holes and returns below them.
Outline2d plate_with_chained_holes(int holes) {
  Outline2d outline{{0, 0}}, back;
  for (int h = 0; h < holes; ++h) {
    const double left = 2 * h + 1, right = left + 1;
    outline.insert(outline.end(), {{left, 1}, {left, 2}, {right, 2}, {right, 1}});
    back.insert(back.begin(), {{left, 1}});
    if (h + 1 < holes) back.insert(back.begin(), {{right, 1}});
  }
  outline.insert(outline.end(), back.begin(), back.end());
  const Outline2d plate = rectangle(0, 0, 2.0 * holes + 1, 3);
  outline.insert(outline.end(), plate.begin(), plate.end());
  return outline;
}

struct Case {
  std::string name;
  Outline2d outline;
};

std::vector<Case> outlines() {
  test::Random random;
  std::vector<Case> cases{
      {"gear", test::gear_outline(23)},
      {"spiral", spiral(60)},
      {"L", {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}},
      {"arrow", {{0, 0}, {2, -1}, {1, 0}, {2, 1}}},
      {"repeated corners", {{0, 0}, {2, 0}, {2, 0}, {1, 0.5}, {1, 0.5}, {1, 0.5}, {2, 2}, {0, 0}}},
      {"spike", {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {2, 3}, {2, 1}, {0, 4}}},
      {"frame", bridged(rectangle(0, 0, 4, 4), 0, reversed(rectangle(1, 1, 3, 3)))},
      {"holes on one corner", bridged(bridged(rectangle(0, 0, 9, 9), 0, {{3, 1}, {5, 2}, {5, 1}}),
                                      0, {{1, 3}, {1, 5}, {2, 5}})},
      {"hole that touches the outline",
       bridged(rectangle(0, 0, 4, 4), 0, {{0, 2}, {2, 3}, {2, 1}})},
      {"ring with a hole",
       bridged(bridged(test::gear_outline(12, 4, 5), 44, {{3.1, -1.7}, {3.0, -1.9}, {2.9, -1.7}}),
               3, shifted(reversed(test::gear_outline(9, 2, 3)), 34))},
      {"row of round holes", plate_with_row_of_holes(5, 24)},
      {"chain of holes", plate_with_chained_holes(6)}};
  for (int i = 0; i < 60; ++i) {
    cases.push_back({fmt::format("skyline {}", i), skyline(random, 3 + i)});
    cases.push_back({fmt::format("star {}", i), star(random, 4 + i)});
  }
  return cases;
}

TEST(SplitPolygon, CoversEveryOutlineExactlyFromAnyCornerAndSide) {
  for (const Case& c : outlines()) {
    const double area = test::shoelace(c.outline);
    ASSERT_GT(area, 0) << c.name;
    for (std::size_t shift = 0; shift < c.outline.size(); shift += 1 + c.outline.size() / 7) {
      for (const bool turned : {false, true}) {
        const Outline2d outline = shifted(turned ? reversed(c.outline) : c.outline, shift);
        const Split got = split(place(outline, Pose::Identity()));
        EXPECT_NEAR(got.area(), area, 1e-6 * area) << c.name << " from " << shift << turned;
        EXPECT_TRUE(is_bounded_by_outline(got)) << c.name;
      }
    }
  }
}

TEST(SplitPolygon, CoversOutlinesOfIntegersWithoutRounding) {
  test::Random random;
  for (int i = 0; i < 200; ++i) {
    const Outline2d outline = shifted(skyline(random, 2 + i % 40), static_cast<std::size_t>(i));
    EXPECT_EQ(split(place(outline, Pose::Identity())).area(), test::shoelace(outline)) << i;
  }
}

TEST(SplitPolygon, CoversTurnedMovedAndBentOutlines) {
  test::Random random;
  for (const Case& c : outlines()) {
    const double area = test::shoelace(c.outline);
    const Split moved = split(place(c.outline, random.motion(100)));
    EXPECT_NEAR(moved.area(), area, 1e-4 * area) << c.name;
    EXPECT_TRUE(is_bounded_by_outline(moved)) << c.name;

    Points bent = place(c.outline, random.motion());
    for (std::size_t i = 0; i < bent.size(); ++i) bent.set(i, bent[i] + 1e-3F * random.direction());
    // Each end of a bridge is one position before and after the change.
    for (std::size_t i = 0; i < bent.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (c.outline[i] == c.outline[j]) bent.set(i, bent[j]);
      }
    }
    const Split of_bent = split(bent);
    EXPECT_NEAR(of_bent.area(), area, 0.05 * area) << c.name;
    EXPECT_TRUE(is_bounded_by_outline(of_bent)) << c.name;
  }
}

TEST(SplitPolygon, LeavesFansThatCoverTheirPolygon) {
  test::Random random;
  for (const int corners : {3, 4, 5, 17, 200}) {
    Outline2d outline;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners;
      outline.emplace_back(std::cos(angle), std::sin(angle));
    }
    for (int turn = 0; turn < 20; ++turn)
      EXPECT_TRUE(split(place(outline, random.motion(10))).is_fan()) << corners;
  }
  EXPECT_TRUE(
      split(place({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}}, Pose::Identity())).is_fan())
      << "corners in line";
  EXPECT_TRUE(split(place({{1, 0}, {2, -1}, {0, 0}, {2, 1}}, Pose::Identity())).is_fan())
      << "its first corner sees all of it";
  EXPECT_FALSE(split(place({{2, -1}, {1, 0}, {2, 1}, {0, 0}}, Pose::Identity())).is_fan());
}

TEST(SplitPolygon, GivesTrianglesForOutlinesWithoutAnInside) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  test::Random random;
  std::vector<Points> polygons;
  polygons.push_back(place({{0, 0}, {1, 1}, {1, 0}, {0, 1}}, Pose::Identity()));  // a bow tie
  polygons.push_back(place({{0, 0}, {3, 0}, {1, 0}, {2, 0}}, Pose::Identity()));  // collinear
  polygons.push_back(place({{1, 1}, {1, 1}, {1, 1}, {1, 1}}, Pose::Identity()));  // one position
  for (const float broken : {nan, inf, 3e38F}) {
    polygons.push_back(place(test::gear_outline(5), Pose::Identity()));
    polygons.back().set(7, {broken, 0, 0});
  }
  for (int i = 0; i < 300; ++i) polygons.push_back(random.dyadic_cloud(4 + i % 60, 1 + i % 3));
  for (int i = 0; i < 300; ++i) {
    Points flat(4 + i % 60);
    for (std::size_t k = 0; k < flat.size(); ++k)
      flat.set(k, {float(random.below(4)), float(random.below(4)), 0});
    polygons.push_back(std::move(flat));
  }
  for (const Points& polygon : polygons) EXPECT_TRUE(is_bounded_by_outline(split(polygon)));
}

TEST(SplitPolygon, NeedsNoMoreStepsThanTheSquareOfTheCorners) {
  test::Random random;
  for (const Outline2d& outline : {test::gear_outline(500), spiral(1000), star(random, 2000),
                                   skyline(random, 1000), plate_with_row_of_holes(40, 50)}) {
    const Points points = place(outline, Pose::Identity());
    std::vector<std::uint32_t> corners(points.size());
    std::iota(corners.begin(), corners.end(), 0U);
    std::vector<CornerTriangle> triangles(corners.size() - 2);
    SplitScratch scratch;
    std::uint64_t steps = corners.size() * corners.size();
    EXPECT_TRUE(split_polygon(points, corners, scratch, steps, triangles));
    std::uint64_t few = 1000;
    EXPECT_FALSE(split_polygon(points, corners, scratch, few, triangles));
    EXPECT_EQ(few, 0U);
    EXPECT_EQ(triangles[5].a, 0U) << "the fan";
  }
}

std::uint64_t steps_for(const Outline2d& outline) {
  const Points points = place(outline, Pose::Identity());
  std::vector<std::uint32_t> corners(points.size());
  std::iota(corners.begin(), corners.end(), 0U);
  std::vector<CornerTriangle> triangles(corners.size() - 2);
  SplitScratch scratch;
  constexpr std::uint64_t kMany = 1'000'000'000;
  std::uint64_t steps = kMany;
  EXPECT_TRUE(split_polygon(points, corners, scratch, steps, triangles));
  return kMany - steps;
}

Outline2d zigzag_ring(int corners) {
  Outline2d outline;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners, radius = 1 + 0.5 * (i % 2);
    outline.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return outline;
}

// Doubling the size multiplies the steps by about 2^1.5 = 2.83; quadratic growth would give 4.
TEST(SplitPolygon, NeedsFarFewerStepsThanTheSquareForOutlinesOfParts) {
  for (const auto& outline :
       {std::function<Outline2d(int)>(zigzag_ring),
        std::function<Outline2d(int)>([](int n) { return spiral(n / 2); }),
        std::function<Outline2d(int)>([](int n) {
          test::Random random;
          return star(random, n);
        }),
        std::function<Outline2d(int)>([](int n) { return test::gear_outline(n / 4); })}) {
    std::uint64_t before = steps_for(outline(4000));
    for (const int n : {8000, 16000}) {
      const std::uint64_t steps = steps_for(outline(n));
      EXPECT_LE(steps, 3 * before) << n;
      before = steps;
    }
    EXPECT_LE(before, 1000U * 16000U) << "what readers allow";
  }
}

// Corners at four places: no test of one finds an ear soon.
TEST(SplitPolygon, EndsWhenItsWorkIsStopped) {
  test::Random random(3);
  Points points;
  for (const auto& [x, y] : {std::pair(-1.0F, -1.0F), {1.0F, -1.0F}, {1.0F, 1.0F}, {-1.0F, 1.0F}})
    points.push_back(Eigen::Vector3f(x, y, 0));
  std::vector<std::uint32_t> corners(50'000);
  for (std::uint32_t& corner : corners) corner = static_cast<std::uint32_t>(random.below(4));
  std::vector<CornerTriangle> triangles(corners.size() - 2);
  SplitScratch scratch;
  std::uint64_t steps = 1'000'000'000;
  std::stop_source stop;
  stop.request_stop();
  const std::stop_token token = stop.get_token();
  const StopScope scope(&token);
  EXPECT_THROW(split_polygon(points, corners, scratch, steps, triangles), Stopped);
}

}  // namespace
}  // namespace trivet
