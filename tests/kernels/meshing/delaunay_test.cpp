#include "kernels/meshing/delaunay.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <map>
#include <set>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3d;

/// Integer coordinates from 0 to 32, with both bounds among them: the lattice and all determinants
/// in double are exact.
Points integer_points(std::size_t n, test::Random& random) {
  Points points;
  points.push_back({0, 0, 0});
  points.push_back({32, 32, 32});
  while (points.size() < n) {
    const auto coordinate = [&] { return static_cast<float>(random.below(33)); };
    points.push_back({coordinate(), coordinate(), coordinate()});
  }
  return points;
}

Vector3d position(const Delaunay& delaunay, PointsView points, std::uint32_t v) {
  const std::size_t n = delaunay.places.size();
  return v < n ? points[delaunay.places[v]].cast<double>() : delaunay.far_corners[v - n];
}

double six_volumes(const std::array<Vector3d, 4>& c) {
  return (c[1] - c[0]).cross(c[2] - c[0]).dot(c[3] - c[0]);
}

/// Positive inside the ball through four positively oriented corners.
double in_ball(const std::array<Vector3d, 4>& c, const Vector3d& p) {
  Eigen::Matrix4d m;
  for (int i = 0; i < 4; ++i) {
    const Vector3d d = c[static_cast<std::size_t>(i)] - p;
    m.row(i) << d.x(), d.y(), d.z(), d.squaredNorm();
  }
  // Laplace expansion, because LU decomposition would round.
  const auto det3 = [&](int a, int b, int e) {
    return m.row(a).head<3>().cross(m.row(b).head<3>()).dot(m.row(e).head<3>());
  };
  return -(-m(0, 3) * det3(1, 2, 3) + m(1, 3) * det3(0, 2, 3) - m(2, 3) * det3(0, 1, 3) +
           m(3, 3) * det3(0, 1, 2));
}

void expect_delaunay(const Delaunay& delaunay, PointsView points) {
  const std::array<Vector3d, 4>& far = delaunay.far_corners;
  double volume = 0;
  for (std::uint32_t t = 0; t < delaunay.tetrahedra.size(); ++t) {
    const Tetrahedron& tetrahedron = delaunay.tetrahedra[t];
    std::array<Vector3d, 4> c;
    for (std::size_t k = 0; k < 4; ++k) c[k] = position(delaunay, points, tetrahedron.corner[k]);
    ASSERT_GT(six_volumes(c), 0);
    volume += six_volumes(c);
    for (std::uint32_t v = 0; v < delaunay.places.size(); ++v)
      ASSERT_LE(in_ball(c, position(delaunay, points, v)), 0) << t << " holds " << v;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint32_t next = tetrahedron.across[k];
      if (next == Tetrahedron::kNone) continue;
      const Tetrahedron& other = delaunay.tetrahedra[next];
      const auto back = std::ranges::find(other.across, t) - other.across.begin();
      ASSERT_LT(back, 4) << "neighbors know each other";
      std::set<std::uint32_t> mine(tetrahedron.corner.begin(), tetrahedron.corner.end()),
          theirs(other.corner.begin(), other.corner.end());
      mine.erase(tetrahedron.corner[k]);
      theirs.erase(other.corner[static_cast<std::size_t>(back)]);
      ASSERT_EQ(mine, theirs) << "and share a face";
    }
  }
  EXPECT_EQ(volume, six_volumes(far)) << "the box is filled once";
}

TEST(FindDelaunay, HasEmptyBallsAndFillsTheBox) {
  for (const std::size_t n : {2U, 3U, 4U, 5U, 20U, 200U}) {
    test::Random random(n);
    const Points points = integer_points(n, random);
    expect_delaunay(find_delaunay(points), points);
  }
}

TEST(FindDelaunay, AcceptsGridsPlanesAndLines) {
  Points grid, plane, line;
  for (int i = 0; i < 125; ++i) {
    const Eigen::Vector3f p =
        8 * Eigen::Vector3f(static_cast<float>(i % 5), static_cast<float>(i / 5 % 5),
                            static_cast<float>(i / 25));
    grid.push_back(p);
    if (p.z() == 16) plane.push_back(p);
    if (p.y() == 16 && p.z() == 8) line.push_back(p);
  }
  for (const Points* points : {&grid, &plane, &line}) {
    const Delaunay delaunay = find_delaunay(*points);
    EXPECT_EQ(delaunay.places.size(), points->size());
    expect_delaunay(delaunay, *points);
  }
}

TEST(FindDelaunay, UsesEachPlaceOnceAndLeavesOutWhatIsNotFinite) {
  test::Random random;
  Points points = integer_points(50, random);
  for (std::size_t i = 0; i < 50; ++i) points.push_back(points[i]);
  points.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  const Delaunay delaunay = find_delaunay(points);
  std::set<std::array<float, 3>> distinct;
  for (std::size_t i = 0; i < 50; ++i)
    distinct.insert({points[i].x(), points[i].y(), points[i].z()});
  EXPECT_EQ(delaunay.places.size(), distinct.size());
  for (const std::uint32_t place : delaunay.places) EXPECT_LT(place, 50U) << "the lowest index";
  expect_delaunay(delaunay, points);
  EXPECT_EQ(find_delaunay(Points()).tetrahedra.size(), 1U);
}

TEST(FindDelaunay, DoesNotDependOnTheOrderOfThePoints) {
  test::Random random;
  const Points points = random.surface(300);
  const auto order = random.permutation(300);
  const Delaunay one = find_delaunay(points);
  const Delaunay other = find_delaunay(test::permuted(points, order));
  ASSERT_EQ(one.tetrahedra.size(), other.tetrahedra.size());
  for (std::size_t i = 0; i < one.places.size(); ++i)
    ASSERT_EQ(one.places[i], order[other.places[i]]);
  for (std::size_t t = 0; t < one.tetrahedra.size(); ++t) {
    ASSERT_EQ(one.tetrahedra[t].corner, other.tetrahedra[t].corner);
    ASSERT_EQ(one.tetrahedra[t].across, other.tetrahedra[t].across);
  }
}

}  // namespace
}  // namespace trivet::kernels
