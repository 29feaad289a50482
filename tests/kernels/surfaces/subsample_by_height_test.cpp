#include <gtest/gtest.h>

#include <limits>

#include "kernels/surfaces/subsample_grid_minimum.hpp"
#include "kernels/surfaces/subsample_local_maximum.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;
using Indices = Column<std::uint32_t>;

Indices grid_minimum(PointsView points, float cell) {
  Indices out;
  SubsampleScratch scratch;
  subsample_grid_minimum(points, cell, out, scratch);
  return out;
}

Indices local_maximum(PointsView points, float radius) {
  Indices out;
  SubsampleScratch scratch;
  subsample_local_maximum(points, radius, out, scratch);
  return out;
}

Points flat(PointsView points) {
  Points out;
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back({points.x[i], points.y[i], 0});
  return out;
}

TEST(SubsampleGridMinimum, KeepsTheLowestPointOfEachSquare) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points = Random(n).dyadic_cloud(n);
    Indices expected;
    for (const auto& [square, indices] : reference::voxels(flat(points), 0.5)) {
      std::uint32_t lowest = indices[0];
      for (const std::uint32_t i : indices) {
        if (points[i].z() < points[lowest].z()) lowest = i;
      }
      expected.push_back(lowest);
    }
    EXPECT_EQ(grid_minimum(points, 0.5F), expected);
  }
}

TEST(SubsampleGridMinimum, BreaksTiesByTheLowestIndex) {
  Points points;
  for (const float z : {3.0F, 1.0F, 1.0F, 2.0F, 1.0F}) points.push_back({0.5F, 0.5F, z});
  EXPECT_EQ(grid_minimum(points, 1), Indices{1});
}

TEST(SubsampleGridMinimum, KeepsTheSameOfPermutedPoints) {
  Random random;
  Points points = random.dyadic_cloud(300);
  for (std::size_t i = 0; i < 300; ++i) {  // no ties
    points.set(i, {points[i].x(), points[i].y(), static_cast<float>(i)});
  }
  const auto order = random.permutation(300);
  Indices found = grid_minimum(test::permuted(points, order), 0.5F);
  for (std::uint32_t& i : found) i = order[i];
  EXPECT_EQ(found, grid_minimum(points, 0.5F));
}

TEST(SubsampleLocalMaximum, RemovesTheHighestOfEachCylinder) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points = Random(n).dyadic_cloud(n);
    const Points shadow = flat(points);
    for (const float radius : {0.125F, 0.5F, 3.0F}) {
      Indices expected;
      for (std::uint32_t i = 0; i < n; ++i) {
        const auto cylinder = reference::within(shadow, shadow[i], radius);
        std::uint32_t highest = cylinder[0];
        for (const std::uint32_t j : cylinder) {
          if (points[j].z() > points[highest].z()) highest = j;
        }
        if (highest != i || cylinder.size() == 1) expected.push_back(i);
      }
      EXPECT_EQ(local_maximum(points, radius), expected) << "n " << n << " radius " << radius;
    }
  }
}

TEST(SubsampleLocalMaximum, KeepsAPointThatIsAlone) {
  Points points;
  points.push_back({0, 0, 5});
  points.push_back({9, 9, 5});
  EXPECT_EQ(local_maximum(points, 1), (Indices{0, 1}));
}

TEST(SubsampleLocalMaximum, ChoosesTheLowestIndexOfEquallyHighPoints) {
  Points points;
  for (int i = 0; i < 4; ++i) points.push_back({static_cast<float>(i) / 4, 0, 1});
  EXPECT_EQ(local_maximum(points, 1), (Indices{1, 2, 3}));
}

TEST(SubsampleByHeight, LeavesOutPointsThatAreNotFinite) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Points points;
  points.push_back({0.5F, 0.5F, kNaN});
  points.push_back({0.5F, 0.5F, -kInfinity});
  points.push_back({0.5F, 0.5F, kInfinity});
  points.push_back({kNaN, 0.5F, 1});
  points.push_back({0.5F, 0.5F, 7});
  EXPECT_EQ(grid_minimum(points, 1), Indices{4});
  EXPECT_EQ(local_maximum(points, 1), Indices{4});
}

TEST(SubsampleGridMinimum, AllocatesNothingTheSecondTime) {
  const Points points = Random().dyadic_cloud(500);
  Indices out;
  SubsampleScratch scratch;
  for (int i = 0; i < 2; ++i) subsample_grid_minimum(points, 0.5F, out, scratch);
  EXPECT_EQ(test::allocations_in([&] { subsample_grid_minimum(points, 0.5F, out, scratch); }), 0U);
}

}  // namespace
}  // namespace trivet::kernels
