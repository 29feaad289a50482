#include "kernels/common/voxel_hash.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "storage/data/neighborhoods.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::Random;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::vector<std::uint32_t> visited(const VoxelHash& grid, const Eigen::Vector3f& query,
                                   float radius) {
  std::vector<std::uint32_t> found;
  grid.visit_within(query, radius, [&](std::uint32_t i, float) { found.push_back(i); });
  return found;
}

Neighborhoods all_neighbors(const VoxelHash& grid, PointsView queries, float radius,
                            std::size_t grain) {
  Neighborhoods out;
  out.offsets.assign(queries.size() + 1, 0);
  test::for_chunks(queries.size(), grain, [&](std::size_t first, std::size_t count) {
    count_radius_neighbors(grid, queries.slice(first, count), radius,
                           std::span(out.offsets).subspan(first + 1, count));
  });
  std::inclusive_scan(out.offsets.begin(), out.offsets.end(), out.offsets.begin());
  out.indices.resize(out.offsets.back());
  test::for_chunks(queries.size(), grain, [&](std::size_t first, std::size_t count) {
    fill_radius_neighbors(grid, queries.slice(first, count), radius,
                          std::span(out.offsets).subspan(first, count + 1), out.indices);
  });
  return out;
}

// Coordinates are dyadic, so float distances and the comparison are exact.
void expect_reference_searches(PointsView points, PointsView queries, float cell, float radius) {
  const VoxelHash grid(points, cell);
  for (std::size_t q = 0; q < queries.size(); ++q) {
    auto found = visited(grid, queries[q], radius);
    EXPECT_EQ(grid.count_within(queries[q], radius), found.size());
    std::ranges::sort(found);
    ASSERT_EQ(found, reference::within(points, queries[q], radius)) << "query " << q;

    const auto nearest = grid.nearest(queries[q], radius);
    ASSERT_EQ(nearest.has_value(), !found.empty()) << "query " << q;
    if (!nearest) continue;
    const auto expected = reference::nearest(points, queries[q], 1)[0];
    ASSERT_EQ(nearest->index, expected) << "query " << q;
    ASSERT_EQ(nearest->squared_distance, reference::squared_distance(points[expected], queries[q]));
  }
}

TEST(VoxelHash, AgreesWithReferenceOnRandomClouds) {
  for (const std::size_t n : test::kSmallSizes) {
    Random random(n);
    const Points points = random.dyadic_cloud(n);
    const Points queries = random.dyadic_cloud(40, 4);
    for (const float cell : {0.125F, 0.5F, 8.0F}) {
      for (const float radius : {0.0F, 0.25F, 0.5F, 1.5F, 20.0F}) {
        SCOPED_TRACE(testing::Message() << "n " << n << " cell " << cell << " radius " << radius);
        expect_reference_searches(points, queries, cell, radius);
        expect_reference_searches(points, points, cell, radius);
      }
    }
  }
}

TEST(VoxelHash, BreaksTiesOnALatticeByTheLowestIndex) {
  Random random;
  Points lattice, centers;
  for (const std::uint32_t i : random.permutation(216)) {
    const Eigen::Vector3f p(static_cast<float>(i % 6), static_cast<float>(i / 6 % 6),
                            static_cast<float>(i / 36));
    lattice.push_back(p);
    centers.push_back(p + Eigen::Vector3f::Constant(0.5F));
  }
  for (const float cell : {0.3F, 1.0F, 2.5F}) {
    expect_reference_searches(lattice, centers, cell, 4);
    expect_reference_searches(lattice, lattice, cell, 1);
  }
}

TEST(VoxelHash, VisitsByVoxelThenIndex) {
  Random random;
  const Points points = random.dyadic_cloud(500);
  const VoxelHash grid(points, 0.5F);
  for (const float radius : {0.75F, 50.0F}) {
    const auto found = visited(grid, {0, 0, 0}, radius);
    ASSERT_GT(found.size(), 5U);
    EXPECT_TRUE(std::ranges::is_sorted(found, {}, [&](std::uint32_t i) {
      const Eigen::Vector3f voxel = (points[i] * 2).array().floor();
      return std::tuple(voxel.z(), voxel.y(), voxel.x(), i);
    }));
  }
}

TEST(VoxelHash, FindsTheSameAmongPermutedPoints) {
  Random random;
  const Points points = random.dyadic_cloud(300);
  const auto order = random.permutation(300);
  const VoxelHash grid(points, 0.5F), shuffled(test::permuted(points, order), 0.5F);
  for (std::size_t q = 0; q < points.size(); ++q) {
    auto found = visited(shuffled, points[q], 0.5F), expected = visited(grid, points[q], 0.5F);
    for (std::uint32_t& i : found) i = order[i];
    std::ranges::sort(found);
    std::ranges::sort(expected);
    ASSERT_EQ(found, expected);
  }
}

TEST(VoxelHash, FindsTheSameFarFromTheOriginAndAtAnotherScale) {
  Random random;
  const Points points = random.dyadic_cloud(300);
  for (const float scale : {1.0F / 1024, 1.0F, 1024.0F}) {
    const Points moved = test::transformed(points, scale * Eigen::Matrix3f::Identity(),
                                           scale * Eigen::Vector3f(4096, -8192, 1000));
    expect_reference_searches(moved, moved, 0.5F * scale, 0.5F * scale);
  }
}

TEST(VoxelHash, HoldsTenMillionVoxelsOnEachAxis) {
  Random random;
  Points points;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f far(random.uniform(-5e6F, 5e6F), random.uniform(-5e6F, 5e6F),
                              random.uniform(-5e6F, 5e6F));
    points.push_back(far.array().floor());
    points.push_back(points[points.size() - 1] + Eigen::Vector3f(1, 0, 1));
  }
  const VoxelHash grid(points, 1);
  for (std::uint32_t i = 0; i < points.size(); i += 2) {
    EXPECT_EQ(visited(grid, points[i], 2), (std::vector{i, i + 1}));
    EXPECT_EQ(grid.nearest(points[i], kInfinity)->index, i);
  }
}

TEST(VoxelHash, FindsTheNearestAtAnyDistance) {
  Random random;
  const Points points = random.dyadic_cloud(100, 1);
  const VoxelHash grid(points, 0.0625F);
  for (int k = 0; k < 50; ++k) {
    const Eigen::Vector3f query = 256 * Eigen::Vector3f(random.dyadic_cloud(1)[0]);
    EXPECT_EQ(grid.nearest(query, kInfinity)->index, reference::nearest(points, query, 1)[0]);
  }
}

TEST(VoxelHash, NeverFindsPointsThatAreNotFinite) {
  Points points;
  points.push_back({kNaN, 0, 0});
  points.push_back({0, kInfinity, 0});
  points.push_back({0, 0, 0});
  const VoxelHash grid(points, 1);
  EXPECT_EQ(grid.size(), 1U);
  EXPECT_EQ(visited(grid, {0, 0, 0}, 1e30F), std::vector<std::uint32_t>{2});
}

TEST(VoxelHash, FindsNothingForQueriesThatMeanNothing) {
  Points points;
  points.push_back({0, 0, 0});
  const VoxelHash grid(points, 1), empty;
  EXPECT_TRUE(visited(grid, {kNaN, 0, 0}, 1).empty());
  EXPECT_TRUE(visited(grid, {0, kInfinity, 0}, 1).empty());
  EXPECT_TRUE(visited(grid, {0, 0, 0}, -1).empty());
  EXPECT_TRUE(visited(grid, {0, 0, 0}, kNaN).empty());
  EXPECT_FALSE(grid.nearest({0, 0, kNaN}, kInfinity).has_value());
  EXPECT_FALSE(grid.nearest({0, 0, 0}, -1).has_value());
  EXPECT_FALSE(empty.nearest({0, 0, 0}, kInfinity).has_value());
}

void expect_reference_rows(PointsView points, float radius) {
  const VoxelHash grid(points, radius);
  const Neighborhoods rows = all_neighbors(grid, points, radius, points.size() + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = rows.view().row(i);
    std::vector<std::uint32_t> found(row.begin(), row.end());
    std::ranges::sort(found);
    ASSERT_EQ(found, reference::within(points, points[i], radius)) << "row " << i;
  }
}

TEST(RadiusNeighbors, AgreesWithReferenceOnRandomClouds) {
  for (const std::size_t n : test::kSmallSizes) {
    expect_reference_rows(Random(n).dyadic_cloud(n), 0.5F);
  }
}

TEST(RadiusNeighbors, IncludesTheSphere) {
  Points lattice;
  for (int i = 0; i < 216; ++i) {
    lattice.push_back(
        {static_cast<float>(i % 6), static_cast<float>(i / 6 % 6), static_cast<float>(i / 36)});
  }
  for (const float radius : {1.0F, 3.0F}) expect_reference_rows(lattice, radius);
}

TEST(RadiusNeighbors, GivesTheSameBitsForAnyChunking) {
  Random random;
  const Points points = random.surface(500);
  const VoxelHash grid(points, 0.2F);
  const Neighborhoods whole = all_neighbors(grid, points, 0.2F, 500);
  EXPECT_GT(whole.indices.size(), 1000U);
  for (const std::size_t grain : {1U, 7U, 64U, 499U}) {
    const Neighborhoods chunked = all_neighbors(grid, points, 0.2F, grain);
    EXPECT_EQ(chunked.offsets, whole.offsets);
    EXPECT_EQ(chunked.indices, whole.indices);
  }
}

TEST(RadiusNeighbors, AllocatesNothing) {
  const Points points = Random().surface(500);
  const VoxelHash grid(points, 0.2F);
  Neighborhoods rows = all_neighbors(grid, points, 0.2F, 500);
  Column<std::uint32_t> counts(points.size());
  EXPECT_EQ(test::allocations_in([&] {
              count_radius_neighbors(grid, points, 0.2F, counts);
              fill_radius_neighbors(grid, points, 0.2F, rows.offsets, rows.indices);
              for (std::size_t i = 0; i < points.size(); ++i) {
                (void)grid.nearest(points[i], 0.2F);
              }
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
