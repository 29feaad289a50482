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

/// A surface whose views are random caps of the direction sphere.
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

/// A scene with points in the order of its grid.
struct Gridded {
  VoxelHash grid;
  std::vector<ViewBits> views;
  Sharers sharers;

  explicit Gridded(const Scene& scene, std::size_t chunk = 100)
      : grid(scene.points, 0.5F * kRadius), sharers(scene.points.size(), kShareRadius) {
    for (const std::uint32_t i : grid.order()) views.push_back(scene.views[i]);
    const PointsView points = grid.ordered_points();
    const VoxelHash fine(points, kShareRadius);
    for (std::size_t first = 0; first < points.size(); first += chunk) {
      const std::size_t count = std::min(chunk, points.size() - first);
      count_sharers(fine, views, points.slice(first, count), first, sharers);
    }
  }
};

// The reference: the points of a view alone, without the others.
TEST(ExtractView, GivesWhatTheViewsPointsAloneGive) {
  const Scene scene(1);
  const Gridded gridded(scene);
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
      gather_viewed_support(gridded.grid, gridded.views, keypoint, kRadius, all);
      extract_view(gridded.grid, all, view, gridded.sharers, found);
      gather_support(alone_grid, areas, keypoint, kRadius, expected);
      EXPECT_GT(found.size, 20U);
      EXPECT_EQ(rows_of(found), rows_of(expected)) << view;
    }
  }
}

TEST(CountSharers, GivesTheSameForAnyChunks) {
  const Scene scene(2);
  EXPECT_EQ(Gridded(scene, 1).sharers.counts, Gridded(scene, 1000).sharers.counts);
}

// More sharers than a byte can count.
TEST(CountSharers, StopsAt255) {
  Scene scene(2);
  for (std::size_t i = 0; i < 300; ++i) {
    scene.points.push_back({5, 5, 5});
    scene.views.push_back(ViewBits{1});
  }
  const Sharers sharers = Gridded(scene).sharers;
  EXPECT_EQ(std::ranges::max(sharers.of_view(0)), 255);
  EXPECT_LT(std::ranges::max(sharers.of_view(5)), 255);
}

TEST(CompareViews, FindsViewsWhoseVisiblePointsDifferLittle) {
  const Scene scene(3);
  const Gridded gridded(scene);
  ViewedSupport all;
  gather_viewed_support(gridded.grid, gridded.views, scene.points[0], kRadius, all);
  const auto is_visible_in = [&](std::size_t v, std::size_t p) {
    return (gridded.views[all.places[p]] >> v & 1U) != 0;
  };
  for (const float share : {0.3F, 0.6F, 1.5F, 2.0F}) {
    LikeViews found;
    const ViewBits wanted = ViewBits{1} | ViewBits{1} << 5U | ViewBits{1} << 63U;
    compare_views(all, wanted, share, found);
    for (const std::size_t a : {0U, 5U, 63U}) {
      std::size_t size = 0;
      for (std::size_t p = 0; p < all.size; ++p) size += is_visible_in(a, p) ? 1 : 0;
      EXPECT_EQ(found.sizes[a], size);
      for (const std::size_t b : {0U, 5U, 63U}) {
        double differing = 0, both = 0;
        for (std::size_t p = 0; p < all.size; ++p) {
          differing += is_visible_in(a, p) != is_visible_in(b, p) ? 1 : 0;
          both += 0.5 * (is_visible_in(a, p) + is_visible_in(b, p));
        }
        EXPECT_EQ((found.alike[a] >> b & 1U) != 0, differing <= share * both) << a << " " << b;
      }
      EXPECT_EQ(found.alike[a] & ~wanted, 0U);
    }
  }
}

TEST(MostTypical, IsTheViewThatMostOfTheOthersAreLike) {
  LikeViews views;
  views.alike[1] = 0b0110;
  views.alike[2] = 0b1110;
  views.alike[3] = 0b1100;
  EXPECT_EQ(most_typical(views, 0b1110), 2U);
  EXPECT_EQ(most_typical(views, 0b1010), 1U) << "the first of equals, of those that are left";
}

TEST(PartialViews, AllocateOnlyOnce) {
  const Scene scene(4);
  const Gridded gridded(scene);
  ViewedSupport all;
  LikeViews like;
  Support support;
  const auto describe = [&](std::size_t at) {
    gather_viewed_support(gridded.grid, gridded.views, scene.points[at], kRadius, all);
    compare_views(all, scene.views[at], 0.2F, like);
    extract_view(gridded.grid, all, 0, gridded.sharers, support);
  };
  for (std::size_t at = 0; at < scene.points.size(); ++at) describe(at);
  EXPECT_EQ(test::allocations_in([&] {
              for (std::size_t at = 0; at < scene.points.size(); ++at) describe(at);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
