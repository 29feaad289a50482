#include "kernels/spin_images/local_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/allocations.hpp"
#include "support/random.hpp"
#include "support/reference_descriptor.hpp"
#include "support/support_of.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3f;
using test::support_of;

constexpr float kRadius = 0.7F;
const Vector3f kUp(0.1F, 0, 1);

/// A curved sheet without symmetry, around its origin.
Points sheet(test::Random& random, std::size_t n, float noise = 0) {
  Points points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const float x = random.uniform(-0.2F, 0.8F), y = random.uniform(-0.25F, 0.3F);
    points.set(i, {x, y, 0.3F * x * x + 0.2F * x * y - 0.4F * y * y * y + random.normal(noise)});
  }
  return points;
}

TEST(LocalFrame, AgreesWithANaiveReference) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    test::Random random(trial);
    const Points points = sheet(random, 5 + 40 * trial);
    std::vector<float> areas(points.size());
    for (float& area : areas) area = random.uniform(0.2F, 1);
    const Support support = support_of(points, kRadius, {0, 0, 0}, areas);
    const LocalFrame frame = local_frame(support, kRadius, kUp);
    const Eigen::Matrix3d expected =
        reference::local_frame(reference::points_of(support), kRadius, kUp.cast<double>());
    EXPECT_LT((frame.axes.cast<double>() - expected).norm(), 2e-4) << trial;
  }
}

TEST(LocalFrame, TurnsAndScalesWithTheSurface) {
  test::Random random;
  const Points points = sheet(random, 400);
  const LocalFrame here = local_frame(support_of(points, kRadius), kRadius, kUp);
  EXPECT_NEAR(here.axes.determinant(), 1, 1e-5F);
  for (const float scale : {1.0F, 0.01F, 300.0F}) {
    const Pose motion = random.motion();
    const Points moved =
        test::transformed(points, scale * motion.linear(), scale * motion.translation());
    const LocalFrame there =
        local_frame(support_of(moved, scale * kRadius, scale * motion.translation()),
                    scale * kRadius, motion.linear() * kUp);
    EXPECT_LT((there.axes - here.axes * motion.linear().transpose()).norm(), 1e-3F);
    EXPECT_NEAR(there.first_ratio, here.first_ratio, 0.01F * here.first_ratio);
    EXPECT_NEAR(there.second_ratio, here.second_ratio, 0.01F * here.second_ratio);
    EXPECT_NEAR(there.lean, here.lean, 1e-3F);
  }
}

TEST(LocalFrame, LeavesNoDirectionOpenToTheOrderOfThePoints) {
  test::Random random;
  const Points points = sheet(random, 300);
  const LocalFrame here = local_frame(support_of(points, kRadius), kRadius, kUp);
  const LocalFrame there = local_frame(
      support_of(test::permuted(points, random.permutation(300)), kRadius), kRadius, kUp);
  EXPECT_LT((here.axes - there.axes).norm(), 1e-4F);
}

TEST(LocalFrame, PutsTheFirstAxisWhereThereIsMoreAndTheLastOnTheSideOfTheNormal) {
  test::Random random;
  const Points points = sheet(random, 500);
  const LocalFrame up = local_frame(support_of(points, kRadius), kRadius, kUp);
  EXPECT_GT(up.axes(0, 0), 0.9F) << "the sheet reaches farther along x";
  EXPECT_GT(up.axes(2, 2), 0.8F);
  const LocalFrame down = local_frame(support_of(points, kRadius), kRadius, -kUp);
  EXPECT_LT((down.axes.row(0) - up.axes.row(0)).norm(), 1e-6F);
  EXPECT_LT((down.axes.row(2) + up.axes.row(2)).norm(), 1e-6F);
  EXPECT_NEAR(down.axes.determinant(), 1, 1e-5F);
}

TEST(LocalFrame, SaysHowSurelyTheSurfaceHoldsIt) {
  test::Random random;
  Points disc, rod;
  for (int k = 0; k < 2000; ++k) {
    const float a = random.uniform(0, 6.2831853F), r = kRadius * std::sqrt(random.uniform(0, 1));
    disc.push_back({r * std::cos(a), r * std::sin(a), 0});
    rod.push_back(
        {random.uniform(-kRadius, kRadius), 0.01F * random.normal(1), 0.005F * random.normal(1)});
  }
  const LocalFrame flat = local_frame(support_of(disc, kRadius), kRadius, kUp);
  EXPECT_LT(flat.first_ratio, 1.15F) << "any turn about the normal fits";
  EXPECT_GT(flat.second_ratio, 1000);
  EXPECT_LT(flat.lean, 0.02F);
  Points half;
  for (std::size_t i = 0; i < disc.size(); ++i) {
    if (disc[i].y() > 0) half.push_back(disc[i]);
  }
  // The weighted mean over half a disc with weights (1 - r)^2 is 0.4 x 2 / pi from its center.
  EXPECT_NEAR(local_frame(support_of(half, kRadius), kRadius, kUp).lean, 0.2546F, 0.02F);
  EXPECT_GT(local_frame(support_of(rod, kRadius), kRadius, kUp).first_ratio, 100);
}

TEST(LocalFrame, IsNoneWhereNothingIsSpread) {
  EXPECT_TRUE(local_frame(Support{}, kRadius, kUp).axes.isZero());
  Points four(4), same(20);
  for (std::size_t i = 0; i < 4; ++i) four.set(i, {0.1F * static_cast<float>(i), 0, 0});
  for (std::size_t i = 0; i < 20; ++i) same.set(i, {0, 0, 0});
  EXPECT_TRUE(local_frame(support_of(four, kRadius), kRadius, kUp).axes.isZero());
  EXPECT_TRUE(local_frame(support_of(same, kRadius), kRadius, kUp).axes.isZero());
}

/// A regular mesh of the sheet.
struct Mesh {
  Points vertices;
  Triangles triangles;
  std::vector<std::uint32_t> all;

  explicit Mesh(std::uint32_t side) {
    for (std::uint32_t j = 0; j <= side; ++j) {
      for (std::uint32_t i = 0; i <= side; ++i) {
        const float x = -0.2F + static_cast<float>(i) / static_cast<float>(side);
        const float y = -0.25F + 0.55F * static_cast<float>(j) / static_cast<float>(side);
        vertices.push_back({x, y, 0.3F * x * x + 0.2F * x * y - 0.4F * y * y * y});
        if (i == side || j == side) continue;
        const std::uint32_t k = j * (side + 1) + i;
        triangles.push_back(k, k + 1, k + side + 1);
        triangles.push_back(k + 1, k + side + 2, k + side + 1);
      }
    }
    all.resize(triangles.size());
    std::iota(all.begin(), all.end(), 0U);
  }
  LocalFrame frame(float max_edge = 1) const {
    return local_frame({vertices, triangles, all, max_edge}, {0, 0, 0}, kRadius, kUp);
  }
};

TEST(LocalFrame, IsTheSameOfTrianglesCoarseOrFineAndOfPointsOnThem) {
  const Matrix3f fine = Mesh(80).frame().axes;
  EXPECT_LT((Mesh(12).frame().axes - fine).norm(), 0.05F);
  test::Random random;
  EXPECT_LT(
      (local_frame(support_of(sheet(random, 20000), kRadius), kRadius, kUp).axes - fine).norm(),
      0.05F);
}

TEST(LocalFrame, GivesTrianglesOfLongEdgesNoWeight) {
  Mesh mesh(40);
  const Matrix3f clean = mesh.frame().axes;
  mesh.vertices.push_back({0.2F, 0.1F, 5});  // an outlier, joined to its neighbors
  const auto stray = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  for (std::uint32_t k = 800; k < 840; ++k) {
    mesh.all.push_back(static_cast<std::uint32_t>(mesh.triangles.size()));
    mesh.triangles.push_back(k, k + 1, stray);
  }
  mesh.vertices.set(stray, {0.2F, 0.1F, 0.6F});
  EXPECT_GT((mesh.frame(10).axes - clean).norm(), 0.05F);
  EXPECT_LT((mesh.frame(0.2F).axes - clean).norm(), 1e-6F);
}

// Noise and density move the axes only slightly: in degrees, for noise in units of the point
// spacing.
TEST(LocalFrame, IsRepeatableUnderNoiseAndAtOtherResolutions) {
  test::Random random;
  const Matrix3f clean = local_frame(support_of(sheet(random, 4000), kRadius), kRadius, kUp).axes;
  const auto off = [&](std::size_t n, float noise) {
    const float spacing = std::sqrt(0.55F / static_cast<float>(n));
    double sum = 0;
    for (int k = 0; k < 20; ++k) {
      const Matrix3f axes =
          local_frame(support_of(sheet(random, n, noise * spacing), kRadius), kRadius, kUp).axes;
      sum += std::acos(
          std::min(1.0, 0.5 * (static_cast<double>((axes * clean.transpose()).trace()) - 1)));
    }
    return sum / 20 * 57.3;
  };
  EXPECT_LT(off(1000, 0), 3);
  EXPECT_LT(off(1000, 0.1F), 3);
  EXPECT_LT(off(1000, 0.5F), 4);
  EXPECT_LT(off(250, 0), 6);
  EXPECT_LT(off(250, 0.5F), 8);
}

TEST(LocalFrame, AllocatesNothing) {
  test::Random random;
  const Support support = support_of(sheet(random, 500), kRadius);
  EXPECT_EQ(test::allocations_in([&] { local_frame(support, kRadius, kUp); }), 0U);
}

LocalFrame aimed(const Support& support, const Vector3f& normal = kUp) {
  LocalFrame frame = local_frame(support, kRadius, normal);
  aim_first_axis(support, kRadius, frame);
  return frame;
}

TEST(AimFirstAxis, AgreesWithANaiveReference) {
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    test::Random random(trial);
    const Points points = sheet(random, 50 + 40 * trial);
    std::vector<float> areas(points.size());
    for (float& area : areas) area = random.uniform(0.2F, 1);
    const Support support = support_of(points, kRadius, {0, 0, 0}, areas);
    const LocalFrame frame = aimed(support);
    const auto [e1, hold] = reference::first_axis(reference::points_of(support), kRadius,
                                                  frame.axes.row(2).cast<double>());
    EXPECT_LT((frame.axes.row(0).transpose().cast<double>() - e1).norm(), 1e-3) << trial;
    EXPECT_NEAR(frame.hold, hold, 1e-3) << trial;
    EXPECT_LT((frame.axes * frame.axes.transpose() - Matrix3f::Identity()).norm(), 1e-5F);
    EXPECT_NEAR(frame.axes.determinant(), 1, 1e-5F);
  }
}

TEST(AimFirstAxis, KeepsTheLastAxisAndPointsToTheHeightOnEitherSide) {
  test::Random random;
  Points points;
  for (int k = 0; k < 3000; ++k) {  // flat, with a bump in one spot
    const float x = random.uniform(-0.5F, 0.5F), y = random.uniform(-0.5F, 0.5F);
    const float bump = std::exp(-60 * (std::pow(x - 0.2F, 2.0F) + std::pow(y - 0.2F, 2.0F)));
    points.push_back({x, y, 0.05F * bump});
  }
  const Support support = support_of(points, kRadius);
  const LocalFrame frame = aimed(support), before = local_frame(support, kRadius, kUp);
  EXPECT_EQ(frame.axes.row(2), before.axes.row(2));
  EXPECT_GT(frame.axes.row(0).dot(Vector3f(1, 1, 0).normalized()), 0.97F);
  EXPECT_GT(frame.hold, 0.5F);
  const LocalFrame down = aimed(support, -kUp);
  EXPECT_LT((down.axes.row(0) - frame.axes.row(0)).norm(), 1e-5F);
}

TEST(AimFirstAxis, HoldsNothingWhereAllIsFlatOrThereIsNoFrame) {
  test::Random random;
  Points flat;
  for (int k = 0; k < 200; ++k)
    flat.push_back({random.uniform(-0.5F, 0.5F), random.uniform(-0.4F, 0.4F), 0});
  const Support support = support_of(flat, kRadius);
  const LocalFrame frame = aimed(support);
  EXPECT_EQ(frame.hold, 0);
  EXPECT_EQ(frame.axes, local_frame(support, kRadius, kUp).axes);
  EXPECT_TRUE(aimed(Support{}).axes.isZero());
}

// The purpose of the first axis: on a shallow dome with a slight tilt, the axis from the scatter
// matrix follows the sampling instead.
TEST(AimFirstAxis, IsMoreRepeatableThanTheScatterOnRoundSurfaces) {
  const auto dome = [](test::Random& random) {
    Points points;
    for (int k = 0; k < 700; ++k) {
      const float x = random.uniform(-0.7F, 0.7F), y = random.uniform(-0.7F, 0.7F);
      points.push_back({x, y, -0.3F * (x * x + y * y) + 0.25F * x * x * x});
    }
    return points;
  };
  double scatter = 0, heights = 0;
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    test::Random random(trial);
    const Support one = support_of(dome(random), kRadius),
                  other = support_of(dome(random), kRadius);
    const auto off = [](const LocalFrame& a, const LocalFrame& b) {
      return static_cast<double>(1 - a.axes.row(0).dot(b.axes.row(0)));
    };
    scatter += off(local_frame(one, kRadius, kUp), local_frame(other, kRadius, kUp));
    heights += off(aimed(one), aimed(other));
  }
  EXPECT_LT(heights, 0.2 * scatter);
}

TEST(AimFirstAxis, AllocatesNothing) {
  test::Random random;
  const Support support = support_of(sheet(random, 500), kRadius);
  LocalFrame frame = local_frame(support, kRadius, kUp);
  EXPECT_EQ(test::allocations_in([&] { aim_first_axis(support, kRadius, frame); }), 0U);
}

}  // namespace
}  // namespace trivet::kernels
