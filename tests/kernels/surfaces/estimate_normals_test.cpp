#include "kernels/surfaces/estimate_normals.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;

Neighborhoods neighbors_within(PointsView points, double radius) {
  Neighborhoods rows;
  rows.offsets.push_back(0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const std::uint32_t j : reference::within(points, points[i], radius)) {
      rows.indices.push_back(j);
    }
    rows.offsets.push_back(static_cast<std::uint32_t>(rows.indices.size()));
  }
  return rows;
}

Neighborhoods one_row_of_all(std::size_t n) {
  Neighborhoods row;
  row.offsets = {0, static_cast<std::uint32_t>(n)};
  for (std::uint32_t i = 0; i < n; ++i) row.indices.push_back(i);
  return row;
}

struct Estimate {
  Normals normals;
  Column<float> residuals;
};

Estimate estimate(PointsView points, const Neighborhoods& rows) {
  const std::size_t n = rows.view().size();
  Estimate out{Normals(n), Column<float>(n)};
  estimate_normals(points, rows, out.normals, out.residuals);
  return out;
}

double angle_between_lines(const Eigen::Vector3f& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d d = a.cast<double>();
  return std::atan2(d.cross(b).norm(), std::abs(d.dot(b)));
}

TEST(EstimateNormals, AgreesWithReferenceOnRandomSurfaces) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points = Random(n).surface(n, 0.01F);
    const Neighborhoods rows = neighbors_within(points, 0.3);
    const Estimate found = estimate(points, rows);
    for (std::size_t i = 0; i < n; ++i) {
      std::vector<Eigen::Vector3d> row;
      for (const std::uint32_t j : rows.view().row(i)) row.push_back(points[j].cast<double>());
      const auto expected = reference::fit_plane(row);
      ASSERT_EQ(std::isnan(found.normals[i].x()), !expected) << "n " << n << " row " << i;
      ASSERT_EQ(std::isnan(found.residuals[i]), !expected) << "n " << n << " row " << i;
      if (!expected) continue;
      // Half a float ulp on each component of the result; before that, the square root of a
      // double's ulp.
      ASSERT_LT(angle_between_lines(found.normals[i], expected->normal), 2e-7);
      ASSERT_NEAR(found.residuals[i], expected->residual, 1e-7 * expected->residual + 1e-8);
      ASSERT_NEAR(found.normals[i].norm(), 1, 2e-7);
    }
  }
}

TEST(EstimateNormals, TurnsWithTheCloudUnderARigidMotion) {
  Random random;
  const Points points = random.surface(300);
  const Neighborhoods rows = neighbors_within(points, 0.3);
  const Pose motion = random.motion();
  const Points moved = test::transformed(points, motion.linear(), motion.translation());
  const Estimate before = estimate(points, rows), after = estimate(moved, rows);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Moved coordinates are rounded by 1e-7, over neighborhoods of about 0.3.
    const Eigen::Vector3f turned = motion.linear() * before.normals[i];
    ASSERT_LT(angle_between_lines(after.normals[i], turned.cast<double>()), 1e-5);
    ASSERT_NEAR(after.residuals[i], before.residuals[i], 1e-6);
  }
}

TEST(EstimateNormals, GivesTheSameBitsFarFromTheOriginAndAtAnotherScale) {
  Random random;
  const Points points = random.dyadic_cloud(100);
  const Neighborhoods rows = neighbors_within(points, 1.5);
  const Estimate expected = estimate(points, rows);
  const Eigen::Matrix3f unit = Eigen::Matrix3f::Identity();
  const Estimate far = estimate(test::transformed(points, unit, {8192, -4096, 1000}), rows);
  EXPECT_TRUE(test::same_bits(far.normals, expected.normals));
  EXPECT_TRUE(test::same_bits(far.residuals, expected.residuals));
  const Estimate large = estimate(test::transformed(points, 1024 * unit, {0, 0, 0}), rows);
  EXPECT_TRUE(test::same_bits(large.normals, expected.normals));
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(large.residuals[i], 1024 * expected.residuals[i]);
  }
}

TEST(EstimateNormals, IsExactOnAPlane) {
  Points points;
  for (int i = 0; i < 25; ++i) {
    points.push_back({static_cast<float>(i % 5), static_cast<float>(i / 5), 3});
  }
  const Estimate found = estimate(points, one_row_of_all(25));
  EXPECT_EQ(Eigen::Vector3f(found.normals[0].cwiseAbs()), Eigen::Vector3f(0, 0, 1));
  EXPECT_EQ(found.residuals[0], 0);
}

TEST(EstimateNormals, GivesNaNForPointsThatSpanNoPlane) {
  Points points;
  for (int i = 0; i < 10; ++i) points.push_back(static_cast<float>(i) * Eigen::Vector3f(1, 2, -3));
  for (int i = 0; i < 10; ++i) points.push_back({5, 5, 5});
  Neighborhoods rows;
  rows.offsets = {0, 0, 1, 3, 14, 17};
  rows.indices = {0, 0, 13, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 11, 12};
  const Estimate found = estimate(points, rows);
  EXPECT_TRUE(std::isnan(found.normals[0].x())) << "no point";
  EXPECT_TRUE(std::isnan(found.normals[1].y())) << "one point";
  EXPECT_TRUE(std::isnan(found.normals[2].z())) << "two points";
  EXPECT_FALSE(std::isnan(found.normals[3].x())) << "a line and a point beside it";
  EXPECT_TRUE(std::isnan(found.normals[4].x())) << "three equal points";
  const Estimate line = estimate(points.view().slice(0, 10), one_row_of_all(10));
  EXPECT_TRUE(std::isnan(line.normals[0].x())) << "a line";
  EXPECT_TRUE(std::isnan(line.residuals[0])) << "a line";
}

TEST(EstimateNormals, GivesTheSameBitsForAnyChunking) {
  const Points points = Random().surface(300);
  const Neighborhoods rows = neighbors_within(points, 0.3);
  const Estimate whole = estimate(points, rows);
  for (const std::size_t grain : {1U, 7U, 64U}) {
    Estimate chunked{Normals(300), Column<float>(300)};
    test::for_chunks(300, grain, [&](std::size_t first, std::size_t count) {
      estimate_normals(points, rows.view().rows(first, count),
                       chunked.normals.span().slice(first, count),
                       std::span(chunked.residuals).subspan(first, count));
    });
    EXPECT_TRUE(test::same_bits(chunked.normals, whole.normals));
    EXPECT_TRUE(test::same_bits(chunked.residuals, whole.residuals));
  }
}

TEST(EstimateNormals, AllocatesNothing) {
  const Points points = Random().surface(300);
  const Neighborhoods rows = neighbors_within(points, 0.3);
  Normals normals(300);
  EXPECT_EQ(test::allocations_in([&] {
              estimate_normals(points, rows, normals);
              orient_normals(points, {0, 0, 5}, normals);
            }),
            0U);
}

TEST(OrientNormals, TurnsEachNormalToTheViewpoint) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    const Points points = random.surface(n);
    const Eigen::Vector3f viewpoint{3, -2, 1};
    Normals normals;
    for (std::size_t i = 0; i < n; ++i) normals.push_back(random.direction());
    const Normals before = normals;
    orient_normals(points, viewpoint, normals);
    for (std::size_t i = 0; i < n; ++i) {
      const double towards = before[i].cast<double>().dot((viewpoint - points[i]).cast<double>());
      if (std::abs(towards) < 1e-5) continue;  // too close to decide in float
      ASSERT_EQ(normals[i], Eigen::Vector3f(towards < 0 ? -before[i] : before[i]));
    }
  }
}

TEST(OrientNormals, KeepsNaN) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  Points points(1);
  Normals normals;
  normals.push_back({kNaN, kNaN, kNaN});
  orient_normals(points, {0, 0, 1}, normals);
  EXPECT_TRUE(std::isnan(normals[0].x()) && std::isnan(normals[0].z()));
}

}  // namespace
}  // namespace trivet::kernels
