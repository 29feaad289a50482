#include "kernels/simulation/drop_points.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "kernels/simulation/add_noise.hpp"
#include "support/allocations.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using Marks = std::vector<std::uint8_t>;

constexpr std::size_t kMany = 20000;

std::size_t num_kept(const Marks& keep) {
  return static_cast<std::size_t>(std::accumulate(keep.begin(), keep.end(), 0));
}
Marks thinned(std::size_t n, double share, std::uint64_t seed = 5) {
  Marks keep(n, 1);
  keep_at_random(share, seed, 0, keep);
  return keep;
}
Marks cut(PointsView points, const Vector3f& direction, double share) {
  Marks keep(points.size(), 1);
  std::vector<float> scratch(points.size());
  drop_half_space(points, cut_share(points, direction, share, scratch), keep);
  return keep;
}

TEST(KeepAtRandom, KeepsTheShare) {
  for (const double share : {0.0625, 0.25, 0.5, 0.9}) {
    // Binomial: 5 standard deviations sqrt(n p (1 - p)).
    const double n = kMany;
    EXPECT_NEAR(static_cast<double>(num_kept(thinned(kMany, share))), n * share,
                5 * std::sqrt(n * share * (1 - share)));
  }
  EXPECT_EQ(num_kept(thinned(kMany, 0)), 0U);
  EXPECT_EQ(num_kept(thinned(kMany, 1)), kMany);
}

TEST(KeepAtRandom, KeepsMoreOfTheSameForALargerShare) {
  const Marks few = thinned(kMany, 0.3), many = thinned(kMany, 0.6);
  for (std::size_t i = 0; i < kMany; ++i) EXPECT_LE(few[i], many[i]);
}

TEST(KeepAtRandom, GivesTheSameMarksForAnyChunking) {
  const Marks whole = thinned(500, 0.5);
  for (const std::size_t grain : {1, 7, 64}) {
    Marks keep(500, 1);
    test::for_chunks(500, grain, [&](std::size_t first, std::size_t count) {
      keep_at_random(0.5, 5, first, std::span(keep).subspan(first, count));
    });
    EXPECT_EQ(keep, whole);
  }
}

TEST(KeepAtRandom, IsIndependentOfOtherSeedsAndOfShotNoise) {
  const Marks a = thinned(kMany, 0.5, 1), b = thinned(kMany, 0.5, 2);
  Points points(kMany), moved(kMany);
  add_shot_noise(points, {Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(2, 2, 2)}, 0.5, 1, 0, moved);
  std::size_t both_seeds = 0, both_kinds = 0;
  for (std::size_t i = 0; i < kMany; ++i) {
    both_seeds += a[i] == 1 && b[i] == 1;
    both_kinds += a[i] == 1 && moved[i].x() > 0;
  }
  // A quarter of them; binomial as above.
  const double n = kMany;
  EXPECT_NEAR(static_cast<double>(both_seeds), n / 4, 5 * std::sqrt(n * 3 / 16));
  EXPECT_NEAR(static_cast<double>(both_kinds), n / 4, 5 * std::sqrt(n * 3 / 16));
}

TEST(DropHalfSpace, DropsWhatLiesBeyondThePlane) {
  for (const std::size_t n : test::kSmallSizes) {
    const Points points =
        test::Random(n).dyadic_cloud(n);  // exact arithmetic: some lie on the plane
    Marks keep(n, 1);
    if (n > 0) keep[0] = 0;
    drop_half_space(points, {{1, -2, 0.5F}, 0.25F}, keep);
    for (std::size_t i = 0; i < n; ++i) {
      const bool gone = Vector3f(1, -2, 0.5F).dot(points[i]) > 0.25F;
      EXPECT_EQ(keep[i] == 1, i > 0 && !gone) << "marks are only cleared";
    }
  }
}

TEST(DropHalfSpace, GivesTheSameMarksForAnyChunking) {
  const Points points = test::Random().surface(500);
  const HalfSpace gone{{0.3F, 0.1F, 0.7F}, 0.1F};
  Marks whole(500, 1);
  drop_half_space(points, gone, whole);
  for (const std::size_t grain : {1, 7, 64}) {
    Marks keep(500, 1);
    test::for_chunks(500, grain, [&](std::size_t first, std::size_t count) {
      drop_half_space(points.view().slice(first, count), gone,
                      std::span(keep).subspan(first, count));
    });
    EXPECT_EQ(keep, whole);
  }
}

TEST(CutShare, HoldsTheShareThatLiesFarthest) {
  for (const std::size_t n : {1U, 2U, 3U, 64U, 1000U}) {
    test::Random random(n);
    const Points points = random.surface(n);
    const Vector3f direction = random.direction();
    for (const double share : {0.0, 0.1, 0.5, 0.999, 1.0}) {
      const Marks keep = cut(points, direction, share);
      const auto expected = static_cast<std::size_t>(share * static_cast<double>(n));
      EXPECT_EQ(n - num_kept(keep), expected) << n << " points, share " << share;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n && keep[i] == 0; ++j) {
          // The kernel's sum of three products and Eigen's may differ in the last bits.
          if (keep[j] == 1) {
            ASSERT_GE(direction.dot(points[i]), direction.dot(points[j]) - 1e-6F);
          }
        }
      }
    }
  }
}

TEST(CutShare, CutsFewerWhereManyLieEquallyFar) {
  Points points(10);  // two layers: eight points at height 1, two at height 2
  for (std::size_t i = 0; i < 10; ++i)
    points.set(i, {static_cast<float>(i), 0, i < 8 ? 1.0F : 2.0F});
  EXPECT_EQ(num_kept(cut(points, {0, 0, 1}, 0.2)), 8U);
  EXPECT_EQ(num_kept(cut(points, {0, 0, 1}, 0.5)), 8U);
  EXPECT_EQ(num_kept(cut(points, {0, 0, 1}, 1)), 0U);
  EXPECT_EQ(num_kept(cut(Points(), {0, 0, 1}, 0.5)), 0U);
}

TEST(CutShare, TurnsWithTheCloud) {
  const Points points = test::Random().dyadic_cloud(500);
  Eigen::Matrix3f quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Vector3f direction(0.5F, 2, -1);
  EXPECT_EQ(cut(points, direction, 0.3),
            cut(test::transformed(points, quarter, Vector3f::Zero()), quarter * direction, 0.3));
}

TEST(DropPoints, AllocatesNothing) {
  const Points points = test::Random().dyadic_cloud(100);
  Marks keep(100, 1);
  std::vector<float> scratch(100);
  EXPECT_EQ(test::allocations_in([&] {
              keep_at_random(0.5, 1, 0, keep);
              drop_half_space(points, cut_share(points, {0, 0, 1}, 0.5, scratch), keep);
            }),
            0U);
}

}  // namespace
}  // namespace trivet::kernels
