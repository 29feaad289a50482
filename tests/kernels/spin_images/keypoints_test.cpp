#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "kernels/spin_images/keypoints_uniform.hpp"
#include "kernels/spin_images/salient_points.hpp"
#include "support/random.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;

TEST(UniformKeypoints, AreOneAVoxelTheNearestToItsMean) {
  for (const std::size_t n : test::kSmallSizes) {
    test::Random random(n);
    const Points points = random.dyadic_cloud(n);
    Column<std::uint32_t> indices;
    UniformScratch scratch;
    find_uniform_keypoints(points, 0.5F, indices, scratch);
    const auto voxel = [](const Vector3f& p) {
      return std::array{std::floor(p.z() / 0.5F), std::floor(p.y() / 0.5F),
                        std::floor(p.x() / 0.5F)};
    };
    std::set<std::array<float, 3>> voxels;
    for (std::size_t i = 0; i < n; ++i) voxels.insert(voxel(points[i]));
    ASSERT_EQ(indices.size(), voxels.size());
    for (const std::uint32_t chosen : indices) {
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      double count = 0;
      const auto is_in = [&](std::size_t i) { return voxel(points[i]) == voxel(points[chosen]); };
      for (std::size_t i = 0; i < n; ++i) {
        if (!is_in(i)) continue;
        mean += points[i].cast<double>();
        ++count;
      }
      mean /= count;
      const auto off = [&](std::size_t i) { return (points[i].cast<double>() - mean).norm(); };
      for (std::size_t i = 0; i < n; ++i) {
        if (is_in(i)) {
          EXPECT_GE(off(i), off(chosen) - 1e-12);
        }
      }
    }
  }
}

/// A plane with a hill, an edge far from the hill, and little noise.
struct Terrain {
  Points points;
  Normals normals;
  Vector3f top{0.3F, -0.2F, 0.15F};

  explicit Terrain(test::Random& random) {
    for (int k = 0; k < 8000; ++k) {
      const float x = random.uniform(-1, 1), y = random.uniform(-1, 1);
      const float dx = x - top.x(), dy = y - top.y();
      const float hill = top.z() * std::exp(-(dx * dx + 2 * dy * dy) / 0.02F);
      points.push_back({x, y, hill + random.normal(0.0005F)});
      const Vector3f slope(hill * 2 * dx / 0.02F, hill * 4 * dy / 0.02F, 1);
      normals.push_back(slope.normalized());
    }
  }
};

// The salient points nearest to the hill lie on it, and no point of the plane is as salient.
TEST(SalientPoints, LieOnAHillAndNotOnThePlane) {
  test::Random random;
  const Terrain terrain(random);
  const VoxelHash grid(terrain.points, 0.15F);
  std::vector<float> iss(terrain.points.size()), harris(iss.size());
  rate_by_iss(grid, terrain.points, 0.15F, iss);
  rate_by_harris(grid, terrain.points, terrain.normals, 0.15F, harris);
  for (const auto& saliency : {iss, harris}) {
    Column<std::uint32_t> indices;
    find_salient_points(grid, terrain.points, saliency, 0.15F, indices);
    ASSERT_FALSE(indices.empty());
    const auto best =
        *std::ranges::max_element(indices, {}, [&](std::uint32_t i) { return saliency[i]; });
    EXPECT_LT((terrain.points[best] - terrain.top).head<2>().norm(), 0.12F);
    for (const std::uint32_t i : indices) {
      if ((terrain.points[i] - terrain.top).head<2>().norm() < 0.4F) continue;
      EXPECT_LT(saliency[i], 0.05F * saliency[best]) << "on the plane";
    }
  }
}

TEST(SalientPoints, MoveWithTheSurface) {
  test::Random random;
  const Terrain terrain(random);
  const Pose motion = random.motion();
  const Points moved = test::transformed(terrain.points, motion.linear(), motion.translation());
  const Normals turned = test::transformed(terrain.normals, motion.linear(), Vector3f::Zero());
  const VoxelHash here(terrain.points, 0.15F), there(moved, 0.15F);
  std::vector<float> a(moved.size()), b(moved.size());
  const auto expect_alike = [&] {
    const float largest = *std::ranges::max_element(a);
    std::size_t off = 0;  // a neighbor on the border may fall on the other side
    for (std::size_t i = 0; i < a.size(); ++i) off += std::abs(a[i] - b[i]) > 0.01F * largest;
    EXPECT_LT(off, a.size() / 100);
  };
  rate_by_iss(here, terrain.points, 0.15F, a);
  rate_by_iss(there, moved, 0.15F, b);
  expect_alike();
  rate_by_harris(here, terrain.points, terrain.normals, 0.15F, a);
  rate_by_harris(there, moved, turned, 0.15F, b);
  expect_alike();
}

TEST(SalientPoints, AreNoneWhereNothingStandsOut) {
  Points line;
  for (int k = 0; k < 50; ++k) line.push_back({0.01F * static_cast<float>(k), 0, 0});
  const Normals up = [] {
    Normals normals;
    for (int k = 0; k < 50; ++k) normals.push_back({0, 0, 1});
    return normals;
  }();
  const VoxelHash grid(line, 0.1F);
  std::vector<float> saliency(50);
  Column<std::uint32_t> indices;
  rate_by_iss(grid, line, 0.1F, saliency);
  find_salient_points(grid, line, saliency, 0.1F, indices);
  EXPECT_TRUE(indices.empty());
  rate_by_harris(grid, line, up, 0.1F, saliency);
  find_salient_points(grid, line, saliency, 0.1F, indices);
  EXPECT_TRUE(indices.empty());
}

TEST(SalientPoints, OfEqualRatesTheFirstStands) {
  Points points;
  for (int k = 0; k < 5; ++k) points.push_back({0.1F * static_cast<float>(k), 0, 0});
  const VoxelHash grid(points, 0.25F);
  const std::vector<float> saliency{1, 1, 0, 2, 2};
  Column<std::uint32_t> indices;
  find_salient_points(grid, points, saliency, 0.25F, indices);
  EXPECT_EQ(indices, (Column<std::uint32_t>{0, 3}));
}

}  // namespace
}  // namespace trivet::kernels
