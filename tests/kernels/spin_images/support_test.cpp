#include "kernels/spin_images/support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Row = std::tuple<float, float, float, float>;

std::vector<Row> rows_of(const Support& support) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < support.size; ++i)
    rows.emplace_back(support.x[i], support.y[i], support.z[i], support.area[i]);
  std::ranges::sort(rows);
  return rows;
}

TEST(GatherSupport, GivesWhatLiesWithinTheRadiusRelativeToTheKeypoint) {
  for (const std::size_t n : test::kSmallSizes) {
    test::Random random(n);
    const Points cloud = random.dyadic_cloud(n);
    std::vector<float> areas(n);
    for (float& area : areas) area = random.uniform(0, 1);
    const VoxelHash grid(cloud, 0.3F);
    Support support;
    for (const float radius : {0.0F, 0.25F, 0.8F, 10.0F}) {
      const Eigen::Vector3f keypoint = n > 0 ? cloud[n / 2] : Eigen::Vector3f(0, 0, 0);
      gather_support(grid, areas, keypoint, radius, support);
      std::vector<Row> expected;
      for (std::size_t i = 0; i < n; ++i) {
        const Eigen::Vector3f d = cloud[i] - keypoint;
        if (d.squaredNorm() <= radius * radius)
          expected.emplace_back(d.x(), d.y(), d.z(), areas[i]);
      }
      std::ranges::sort(expected);
      EXPECT_EQ(rows_of(support), expected) << n << " within " << radius;
      ASSERT_GE(support.area.size(), support.size + Support::kLanes);
      for (std::size_t k = 0; k < Support::kLanes; ++k)
        EXPECT_EQ(support.area[support.size + k], 0);
    }
  }
}

TEST(GatherSupport, UsesAnAreaOfOneWhereNoneIsGivenAndAllocatesOnce) {
  test::Random random;
  const Points cloud = random.surface(500);
  const VoxelHash grid(cloud, 0.3F);
  Support support;
  gather_support(grid, {}, cloud[0], 3, support);
  EXPECT_EQ(support.size, 500U);
  EXPECT_TRUE(std::all_of(support.area.begin(), support.area.begin() + 500,
                          [](float area) { return area == 1; }));
  EXPECT_EQ(test::allocations_in([&] {
              for (std::size_t i = 0; i < 500; ++i) gather_support(grid, {}, cloud[i], 1, support);
            }),
            0U);
}

TEST(ShareAreas, SharesADiscAmongThePointsInTheBallAroundEach) {
  for (const std::size_t n : test::kSmallSizes) {
    test::Random random(n);
    const Points cloud = random.dyadic_cloud(n);
    constexpr float kRadius = 0.25F;
    std::vector<float> areas(n);
    share_areas(VoxelHash(cloud, kRadius), cloud, kRadius, areas);
    for (std::size_t i = 0; i < n; ++i) {
      int sharers = 0;
      for (std::size_t k = 0; k < n; ++k)
        sharers += (cloud[k] - cloud[i]).squaredNorm() <= kRadius * kRadius;
      EXPECT_FLOAT_EQ(areas[i], 3.14159265F * kRadius * kRadius / static_cast<float>(sharers));
    }
  }
}

TEST(ShareAreas, MakesUpForDensity) {
  test::Random random;
  Points plane;  // four times the density on one half
  for (int k = 0; k < 50000; ++k) {
    const float x = k % 5 == 0 ? random.uniform(0, 1) : random.uniform(1, 2);
    plane.push_back({x, random.uniform(0, 1), 0});
  }
  std::vector<float> areas(plane.size());
  share_areas(VoxelHash(plane, 0.03F), plane, 0.03F, areas);
  double sparse = 0, dense = 0;
  for (std::size_t i = 0; i < plane.size(); ++i)
    (plane[i].x() < 1 ? sparse : dense) += static_cast<double>(areas[i]);
  EXPECT_NEAR(sparse, 1, 0.1);
  EXPECT_NEAR(dense, 1, 0.1);
}

TEST(ShareAreas, GivesNoAreaToWhatIsNowhereAndAllocatesNothing) {
  test::Random random;
  Points cloud = random.surface(300);
  cloud.set(7, Eigen::Vector3f::Constant(std::nanf("")));
  const VoxelHash grid(cloud, 0.2F);
  std::vector<float> areas(300), parts(300);
  EXPECT_EQ(test::allocations_in([&] { share_areas(grid, cloud, 0.2F, areas); }), 0U);
  EXPECT_EQ(areas[7], 0);
  for (const std::size_t first : {0U, 100U, 200U})
    share_areas(grid, cloud.view().slice(first, 100), 0.2F, std::span(parts).subspan(first, 100));
  EXPECT_EQ(areas, parts);
}

}  // namespace
}  // namespace trivet::kernels
