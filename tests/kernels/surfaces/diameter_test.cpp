#include "kernels/surfaces/diameter.hpp"

#include <gtest/gtest.h>

#include "support/random.hpp"
#include "support/reference_model.hpp"
#include "support/shapes.hpp"

namespace trivet::kernels {
namespace {

using test::Random;

// The contract: one part in 10^6.
void expect_exact(PointsView points) {
  const double expected = reference::diameter(points);
  EXPECT_NEAR(find_diameter(points), expected, 1e-6 * expected);
}

TEST(FindDiameter, AgreesWithReferenceOnRandomClouds) {
  for (const std::size_t n : test::kSmallSizes) {
    SCOPED_TRACE(n);
    expect_exact(Random(n).dyadic_cloud(n));
    expect_exact(Random(n).surface(n));
  }
}

TEST(FindDiameter, AgreesWithReferenceOnSpheres) {
  Random random;
  for (const float noise : {0.0F, 1e-6F, 1e-3F, 0.1F}) {
    Points points;
    for (int i = 0; i < 2000; ++i) {
      points.push_back((1 + random.normal(noise)) * random.direction() + Eigen::Vector3f(5, 6, 7));
    }
    expect_exact(points);
  }
}

// Bodies of constant width: every boundary point is an end of a diameter, and no center halves the
// diameters.
TEST(FindDiameter, AgreesWithReferenceOnAReuleauxTriangle) {
  Points points;
  for (int i = 0; i < 1500; ++i) {
    const double corner = 2 * std::numbers::pi / 3 * (i % 3);
    const double angle = corner + std::numbers::pi * (5.0 / 6 + i / 4500.0);
    points.push_back(Eigen::Vector3d(std::cos(corner) + std::sqrt(3) * std::cos(angle),
                                     std::sin(corner) + std::sqrt(3) * std::sin(angle), 0)
                         .cast<float>());
  }
  expect_exact(points);
}

TEST(FindDiameter, FindsTheDiagonalOfABoxAnywhere) {
  Random random;
  const test::Shape box = test::box({0, 0, 0}, {2, 3, 6});
  for (int i = 0; i < 10; ++i) {
    EXPECT_NEAR(find_diameter(box.moved(random.motion(10)).vertices), 7, 7e-6);
  }
}

TEST(FindDiameter, IsNotMisledByTheFarthestPointFromAStart) {
  // Sweeps between farthest points may stop short of the diameter; the exact search may not.
  Random random;
  for (int i = 0; i < 200; ++i)
    expect_exact(Random(static_cast<std::uint64_t>(i)).dyadic_cloud(12, 1));
}

TEST(FindDiameter, IsZeroWithoutTwoPlaces) {
  EXPECT_EQ(find_diameter(PointsView{}), 0);
  Points same;
  for (int i = 0; i < 100; ++i) {
    same.push_back({1, 2, 3});
    EXPECT_EQ(find_diameter(same), 0);
  }
}

}  // namespace
}  // namespace trivet::kernels
