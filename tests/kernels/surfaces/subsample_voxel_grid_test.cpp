#include "kernels/surfaces/subsample_voxel_grid.hpp"

#include <gtest/gtest.h>

#include "kernels/surfaces/subsample_approximate_voxel_grid.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;

Points voxel_grid(PointsView points, float cell) {
  Points out;
  SubsampleScratch scratch;
  subsample_voxel_grid(points, cell, out, scratch);
  return out;
}

Points approximate_voxel_grid(PointsView points, float cell) {
  Points out;
  subsample_approximate_voxel_grid(points, cell, out);
  return out;
}

Eigen::Vector3d centroid(PointsView points, const std::vector<std::uint32_t>& indices) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : indices) sum += points[i].cast<double>();
  return sum / static_cast<double>(indices.size());
}

TEST(SubsampleVoxelGrid, GivesTheCentroidOfEachVoxel) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points = Random(n).dyadic_cloud(n);
    const Points found = voxel_grid(points, 0.5F);
    const auto expected = reference::voxels(points, 0.5);
    ASSERT_EQ(found.size(), expected.size());
    std::size_t v = 0;
    for (const auto& [voxel, indices] : expected) {
      ASSERT_EQ(found[v], Eigen::Vector3f(centroid(points, indices).cast<float>()))
          << "voxel " << v;
      ++v;
    }
  }
}

TEST(SubsampleVoxelGrid, GivesTheSameForPermutedPoints) {
  Random random;
  const Points points = random.dyadic_cloud(500);  // dyadic: sums are exact in any order
  const Points shuffled = test::permuted(points, random.permutation(500));
  EXPECT_TRUE(test::same_bits(voxel_grid(points, 0.5F), voxel_grid(shuffled, 0.5F)));
}

TEST(SubsampleVoxelGrid, MovesAndGrowsWithTheCloud) {
  const Points points = Random().dyadic_cloud(200);
  const auto moved = [](PointsView p) {
    return test::transformed(p, 2 * Eigen::Matrix3f::Identity(), {1024, -512, 64});
  };
  const Points found = voxel_grid(moved(points), 1.0F), expected = moved(voxel_grid(points, 0.5F));
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    ASSERT_LT((found[i] - expected[i]).norm(), 2e-4);  // an ulp at 1024
  }
}

TEST(SubsampleVoxelGrid, LeavesOutPointsThatAreNotFinite) {
  Points points;
  points.push_back({std::nanf(""), 0, 0});
  points.push_back({1, 2, 3});
  const Points found = voxel_grid(points, 1);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], Eigen::Vector3f(1, 2, 3));
}

TEST(SubsampleVoxelGrid, AllocatesNothingTheSecondTime) {
  const Points points = Random().dyadic_cloud(500);
  Points out;
  SubsampleScratch scratch;
  for (int i = 0; i < 2; ++i) subsample_voxel_grid(points, 0.5F, out, scratch);
  EXPECT_EQ(test::allocations_in([&] { subsample_voxel_grid(points, 0.5F, out, scratch); }), 0U);
}

TEST(SubsampleApproximateVoxelGrid, GivesOneCentroidForARunInOneVoxel) {
  Points points;
  for (int i = 0; i < 4; ++i) points.push_back({static_cast<float>(i) / 8, 0.25F, -0.25F});
  const Points found = approximate_voxel_grid(points, 0.5F);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0], Eigen::Vector3f(0.1875F, 0.25F, -0.25F));
}

TEST(SubsampleApproximateVoxelGrid, KeepsTheSumOfAFewVoxelsApart) {
  // With few voxels, hash slots are rarely shared: the result then equals the exact voxel grid up
  // to order.
  const Points points = Random().dyadic_cloud(500, 1);
  const Points found = approximate_voxel_grid(points, 1), expected = voxel_grid(points, 1);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(reference::within(found, expected[i], 0).size(), 1U);
  }
}

TEST(SubsampleApproximateVoxelGrid, NeverMixesVoxelsAndNeverLosesOne) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points = Random(n).dyadic_cloud(n);
    const Points found = approximate_voxel_grid(points, 0.125F);
    const auto before = reference::voxels(points, 0.125), after = reference::voxels(found, 0.125);
    ASSERT_LE(before.size(), found.size());
    ASSERT_EQ(before.size(), after.size());
    for (const auto& [voxel, indices] : after) EXPECT_TRUE(before.contains(voxel));
  }
}

TEST(SubsampleApproximateVoxelGrid, LeavesOutPointsThatAreNotFinite) {
  Points points;
  points.push_back({0, std::nanf(""), 0});
  EXPECT_TRUE(approximate_voxel_grid(points, 1).empty());
}

}  // namespace
}  // namespace trivet::kernels
