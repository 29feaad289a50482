#include "kernels/spin_images/partial_views.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

constexpr float kRadius = 0.4F, kShareRadius = 0.15F;

/// A surface whose views are random caps of directions.
struct Scene {
  Points points;
  std::vector<ViewBits> views;

  explicit Scene(std::uint64_t seed) {
    test::Random random(seed);
    for (int i = 0; i < 900; ++i) {
      points.push_back({random.uniform(-0.5F, 0.5F), random.uniform(-0.5F, 0.5F),
                        random.uniform(-0.05F, 0.05F)});
      const ViewBits most = random.uniform(0, 1) > 0.3F ? 1 : 0;
      const ViewBits few = random.uniform(0, 1) > 0.8F ? 1 : 0;
      views.push_back(ViewBits{1} | most << 5U | few << 63U);
    }
  }
};

using Row = std::array<float, 4>;

std::vector<Row> rows_of(const Support& support) {
  std::vector<Row> rows;
  for (std::size_t k = 0; k < support.size; ++k)
    rows.push_back({support.x[k], support.y[k], support.z[k], support.area[k]});
  std::ranges::sort(rows);
  return rows;
}

Sharers sharers_of(const Scene& scene, std::size_t chunk) {
  const VoxelHash fine(scene.points, kShareRadius);
  Sharers sharers;
  sharers.num_points = scene.points.size();
  sharers.counts.resize(kMostPartialViews * sharers.num_points);
  for (std::size_t first = 0; first < scene.points.size(); first += chunk) {
    const std::size_t count = std::min(chunk, scene.points.size() - first);
    count_sharers(fine, scene.views, scene.points.view().slice(first, count), first, kShareRadius,
                  sharers.counts);
  }
  return sharers;
}

// The reference: the points of a view alone, as if there were no others.
TEST(TakeView, GivesWhatTheViewsPointsAloneGive) {
  const Scene scene(1);
  const Sharers sharers = sharers_of(scene, 100);
  const VoxelHash grid(scene.points, 0.5F * kRadius);
  ViewedSupport all;
  Support found, expected;
  for (const std::size_t view : {0U, 5U, 63U}) {
    Points alone;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      if ((scene.views[i] >> view & 1U) != 0) alone.push_back(scene.points[i]);
    }
    std::vector<float> areas(alone.size());
    share_areas(VoxelHash(alone, kShareRadius), alone, kShareRadius, areas);
    const VoxelHash alone_grid(alone, 0.5F * kRadius);
    for (const std::size_t at : {0U, 17U, 400U}) {
      const Eigen::Vector3f keypoint = scene.points[at];
      gather_viewed_support(grid, scene.views, keypoint, kRadius, all);
      take_view(all, view, sharers.of_view(view), kShareRadius, found);
      gather_support(alone_grid, areas, keypoint, kRadius, expected);
      EXPECT_GT(found.size, 20U);
      EXPECT_EQ(rows_of(found), rows_of(expected)) << view;
    }
  }
}

TEST(CountSharers, GivesTheSameForAnyChunks) {
  const Scene scene(2);
  EXPECT_EQ(sharers_of(scene, 1).counts, sharers_of(scene, 1000).counts);
}

TEST(CountDifferences, CountsPointsThatOneViewSees) {
  const Scene scene(3);
  const VoxelHash grid(scene.points, 0.5F * kRadius);
  ViewedSupport all;
  gather_viewed_support(grid, scene.views, scene.points[0], kRadius, all);
  const auto differing = [&](std::size_t a, std::size_t b) {
    std::size_t count = 0;
    for (std::size_t p = 0; p < all.size; ++p)
      count += (all.views[p] >> a & 1U) != (all.views[p] >> b & 1U) ? 1 : 0;
    return count;
  };
  for (const auto& [a, b] : {std::pair(0U, 5U), {0U, 63U}, {5U, 63U}, {0U, 7U}}) {
    EXPECT_EQ(count_differences(all.seen_by(a), all.seen_by(b)), differing(a, b));
    EXPECT_GT(differing(a, b), 0U);
  }
  EXPECT_EQ(count_differences(all.seen_by(5), all.seen_by(5)), 0U);
}

TEST(PartialViews, AllocateOnlyOnce) {
  const Scene scene(4);
  const Sharers sharers = sharers_of(scene, 100);
  const VoxelHash grid(scene.points, 0.5F * kRadius);
  ViewedSupport all;
  Support support;
  const auto describe = [&](std::size_t at) {
    gather_viewed_support(grid, scene.views, scene.points[at], kRadius, all);
    take_view(all, 0, sharers.of_view(0), kShareRadius, support);
  };
  for (std::size_t at = 0; at < scene.points.size(); ++at) describe(at);
  EXPECT_EQ(test::allocations_in([&] {
              for (std::size_t at = 0; at < scene.points.size(); ++at) describe(at);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
