#include "kernels/support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

TEST(GatherSupport, TakesAnAreaOfOneWhereNoneIsGivenAndAllocatesOnce) {
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

}  // namespace
}  // namespace trivet::kernels
