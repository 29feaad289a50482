#include "kernels/common/voxels.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;

TEST(RadixSort, SortsByKeyAndKeepsTheOrderOfEqualKeys) {
  for (const std::size_t n : test::kSmallSizes) {
    for (const std::uint64_t max_key : {0UL, 1UL, 2000UL, 1UL << 40, ~0UL}) {
      Random random(n + max_key);
      Column<std::uint64_t> keys(n);
      Column<std::uint32_t> values(n);
      std::vector<std::pair<std::uint64_t, std::uint32_t>> expected;
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint64_t wide = std::uint64_t{random.below(1U << 31)} << 33;
        const std::uint64_t key = i % 3 == 0 ? wide + i : i % 7;
        keys[i] = max_key == ~0UL ? key : key % (max_key + 1);
        values[i] = i;
        expected.emplace_back(keys[i], i);
      }
      std::ranges::stable_sort(expected, {}, [](const auto& pair) { return pair.first; });
      RadixScratch scratch;
      radix_sort(keys, values, max_key, scratch);
      for (std::size_t i = 0; i < n; ++i) {
        ASSERT_EQ(keys[i], expected[i].first) << "n " << n << " max_key " << max_key;
        ASSERT_EQ(values[i], expected[i].second) << "n " << n << " max_key " << max_key;
      }
    }
  }
}

void expect_reference_groups(PointsView points, float cell) {
  Voxels voxels;
  VoxelScratch scratch;
  group_by_voxel(points, fit_lattice(points, cell), voxels, scratch);
  const auto expected = reference::voxels(points, cell);
  ASSERT_EQ(voxels.size(), expected.size());
  ASSERT_EQ(voxels.offsets.size(), expected.size() + 1);
  std::size_t v = 0;
  for (const auto& [voxel, indices] : expected) {
    ASSERT_TRUE(std::ranges::equal(voxels.points_of(v), indices)) << "voxel " << v;
    ++v;
  }
}

TEST(GroupByVoxel, AgreesWithReferenceInContentAndOrder) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    expect_reference_groups(random.dyadic_cloud(n), 0.5F);
    expect_reference_groups(random.dyadic_cloud(n), 0.0625F);
  }
}

// Along a row of pixels, several consecutive points share a voxel, and some return to it.
TEST(GroupByVoxel, KeepsTheOrderOfPointsThatFollowEachOtherInAVoxel) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (const std::size_t n : {255U, 256U, 257U, 2000U}) {
    Points points;
    for (std::size_t i = 0; i < n; ++i) {
      const auto at = static_cast<float>(i % 300);
      points.push_back({0.125F * at, i % 64 == 40 ? kNaN : 1.0F, 0.0625F * at});
    }
    expect_reference_groups(points, 0.5F);
  }
}

TEST(GroupByVoxel, PutsPointsOnALatticePlaneIntoTheUpperVoxel) {
  Points points;
  for (const float x : {-1.0F, -0.5F, -0.0F, 0.0F, 0.5F, 1.0F}) points.push_back({x, 0, 0});
  expect_reference_groups(points, 0.5F);
}

TEST(GroupByVoxel, HoldsTenMillionVoxelsOnEachAxis) {
  Random random;
  Points points;
  for (int i = 0; i < 300; ++i) {
    const auto coordinate = [&] { return std::floor(random.uniform(-5e6F, 5e6F)); };
    points.push_back({coordinate(), coordinate(), coordinate()});
    points.push_back({points[points.size() - 1].x(), coordinate(), 3});
  }
  EXPECT_FALSE(fit_lattice(points, 1).fits_64_bits());
  expect_reference_groups(points, 1);
}

TEST(GroupByVoxel, SurvivesExtentsBeyondAllCounting) {
  Points points;
  points.push_back({3e38F, -3e38F, 0});
  points.push_back({-3e38F, 3e38F, 1e-30F});
  points.push_back({0, 0, 0});
  Voxels voxels;
  VoxelScratch scratch;
  group_by_voxel(points, fit_lattice(points, 1e-30F), voxels, scratch);
  EXPECT_EQ(voxels.order.size(), 3U);
}

TEST(GroupByVoxel, LeavesOutPointsThatAreNotFinite) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Points points;
  points.push_back({kNaN, 0, 0});
  points.push_back({1, 1, 1});
  points.push_back({0, -kInfinity, 0});
  points.push_back({0, 0, kInfinity});
  expect_reference_groups(points, 0.25F);
  Voxels voxels;
  VoxelScratch scratch;
  group_by_voxel(points, fit_lattice(points, 0.25F), voxels, scratch);
  EXPECT_EQ(voxels.order, Column<std::uint32_t>{1});
}

TEST(GroupByVoxel, AllocatesNothingTheSecondTime) {
  const Points points = Random().dyadic_cloud(500);
  Voxels voxels;
  VoxelScratch scratch;
  const auto group = [&] { group_by_voxel(points, fit_lattice(points, 0.5F), voxels, scratch); };
  group();
  group();  // both buffers of the sort have grown by now
  EXPECT_EQ(test::allocations_in(group), 0U);
}

}  // namespace
}  // namespace trivet::kernels
