#include "engine/evaluation/degrade_scene.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "engine/common/thread_limit.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "kernels/surfaces/subsample_approximate_voxel_grid.hpp"
#include "kernels/surfaces/subsample_grid_minimum.hpp"
#include "kernels/surfaces/subsample_local_maximum.hpp"
#include "kernels/surfaces/subsample_voxel_grid.hpp"
#include "support/depth_scan.hpp"
#include "support/random.hpp"

namespace trivet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kDiameter = 0.25F;
constexpr float kDepth = 1;
constexpr double kResolution = 0.01;  ///< of `wall`

/// 200 x 150 pixels of a wall at kDepth: neighbors are a pixel pitch apart.
Cloud wall() {
  const test::DepthScan scan = test::depth_scan(200, 150, [](float, float) { return kDepth; });
  Cloud cloud;
  cloud.points = scan.points;
  cloud.grid = scan.grid;
  cloud.normals = Normals(scan.points.size());
  cloud.viewpoint = Vector3f(0.5F, 0.25F, -2);
  return cloud;
}

/// A bumpy surface without a pixel grid.
Cloud bumps(std::size_t n) {
  Cloud cloud;
  cloud.points = test::Random(n).surface(n);
  return cloud;
}

Cloud degraded(Cloud cloud, const DegradeOptions& options, std::uint64_t seed = 1) {
  const Result<void> done = degrade_scene(cloud, options, kDiameter, seed);
  EXPECT_TRUE(done) << done.error().message;
  return cloud;
}

/// Root mean square displacement of the points along each axis.
Vector3d sigmas(PointsView before, PointsView after) {
  EXPECT_EQ(before.size(), after.size());
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < before.size(); ++i)
    sum += (after[i].cast<double>() - before[i].cast<double>()).cwiseAbs2();
  return (sum / static_cast<double>(before.size())).cwiseSqrt();
}

/// Expects agreement within five standard errors of a normal sample's standard deviation, plus
/// float rounding.
void expect_sigma(double found, double expected, std::size_t n) {
  EXPECT_NEAR(found, expected, 5 * expected / std::sqrt(2 * static_cast<double>(n)) + 1e-6);
}

/// All degradations, for properties common to them.
const std::vector<DegradeOptions> kEach{{.scattered = true},
                                        {.noise = 0.3F},
                                        {.noise_diameters = 0.01F},
                                        {.ray_noise = 0.5F},
                                        {.shot_noise = 0.2F},
                                        {.keep = 0.5F},
                                        {.subsampler = Subsampler::voxel_grid},
                                        {.subsampler = Subsampler::approximate_voxel_grid},
                                        {.subsampler = Subsampler::grid_minimum},
                                        {.subsampler = Subsampler::local_maximum}};

TEST(DegradeScene, LeavesACloudAloneByDefault) {
  const Cloud before = wall();
  for (const DegradeOptions& options : {DegradeOptions{}, DegradeOptions{.cell = 0.5F}}) {
    const Cloud after = degraded(before, options);
    EXPECT_TRUE(test::same_bits(before.points, after.points));
    ASSERT_TRUE(after.grid);
    EXPECT_EQ(before.grid->point_index, after.grid->point_index);
    EXPECT_EQ(after.normals.size(), before.normals.size());
  }
  Cloud mesh = bumps(3);
  mesh.triangles.push_back(0, 1, 2);
  EXPECT_FALSE(degraded(mesh, {}).viewpoint);
  EXPECT_EQ(degraded(mesh, {}).triangles.size(), 1U);
}

TEST(DegradeScene, KeepsTheViewpointOfScatteredPoints) {
  Cloud scan = wall();
  scan.triangles.push_back(0, 1, 200);
  for (const DegradeOptions& options : kEach) {
    const Cloud after = degraded(scan, options);
    EXPECT_FALSE(after.grid || after.camera);
    EXPECT_TRUE(after.normals.empty() && after.triangles.empty());
    EXPECT_EQ(after.viewpoint, scan.viewpoint);
  }
  EXPECT_TRUE(test::same_bits(degraded(scan, {.scattered = true}).points, scan.points));
  scan.camera = Camera{100, 100, 100, 75, 1};
  EXPECT_EQ(degraded(scan, {.scattered = true}).viewpoint, Vector3f(0, 0, 0)) << "of the camera";
  EXPECT_EQ(degraded(bumps(100), {.scattered = true}).viewpoint, Vector3f(0, 0, 0));
}

TEST(DegradeScene, LeavesAScanToRecognize) {
  const test::DepthScan bowl =
      test::depth_scan(200, 150, [](float a, float b) { return 1 + 0.5F * (a * a + b * b); });
  Cloud cloud;
  cloud.points = bowl.points;
  cloud.grid = bowl.grid;
  StageTimes times;
  const auto prepared =
      engine::prepare_scene(degraded(cloud, {.noise = 0.2F, .keep = 0.5F}), {}, times);
  ASSERT_TRUE(prepared) << prepared.error().message;
  EXPECT_EQ(prepared->images.size(), 1U);
}

TEST(DegradeScene, AddsNoiseInResolutionsOfTheScan) {
  const Cloud scan = wall();
  const Vector3d found = sigmas(scan.points, degraded(scan, {.noise = 0.5F}).points);
  for (const double sigma : found) expect_sigma(sigma, 0.5 * kResolution, scan.points.size());
}

// Points on a lattice of pitch 1/16. A cloud's nearest neighbors have that distance; a mesh of
// squares with diagonals has a mean edge length of (2 + sqrt 2) / 3 of it, up to its border.
TEST(DegradeScene, MeasuresTheResolutionOfACloudByNeighborsAndOfAMeshByEdges) {
  constexpr std::uint32_t kSide = 100;
  constexpr double kPitch = 1.0 / 16;
  Cloud lattice;
  for (std::uint32_t v = 0; v < kSide; ++v) {
    for (std::uint32_t u = 0; u < kSide; ++u) {
      lattice.points.push_back({static_cast<float>(u) / 16, static_cast<float>(v) / 16, 3});
      const std::uint32_t i = v * kSide + u;
      if (u == 0 || v == 0) continue;
      lattice.triangles.push_back(i - kSide - 1, i - kSide, i);
      lattice.triangles.push_back(i - kSide - 1, i, i - 1);
    }
  }
  const auto sigma = [&] {
    return sigmas(lattice.points, degraded(lattice, {.noise = 1}).points).mean();
  };
  const std::size_t n = 3 * lattice.points.size();
  expect_sigma(sigma(), kPitch * (2 + std::numbers::sqrt2) / 3, n);
  lattice.triangles = {};
  expect_sigma(sigma(), kPitch, n);
}

TEST(DegradeScene, AddsNoiseInDiametersBesideIt) {
  const Cloud scan = wall();
  const std::size_t n = scan.points.size();
  for (const float noise : {0.0F, 0.3F}) {
    const Vector3d found =
        sigmas(scan.points, degraded(scan, {.noise = noise, .noise_diameters = 0.02F}).points);
    const double expected =
        std::hypot(static_cast<double>(noise) * kResolution, 0.02 * static_cast<double>(kDiameter));
    for (const double sigma : found) expect_sigma(sigma, expected, n);
  }
}

TEST(DegradeScene, AddsRayNoiseAlongTheLinesOfSight) {
  const Cloud scan = wall();
  const Cloud after = degraded(scan, {.ray_noise = 2});
  double along = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Vector3d ray = (scan.points[i] - *scan.viewpoint).cast<double>().normalized();
    const Vector3d change = after.points[i].cast<double>() - scan.points[i].cast<double>();
    along += std::pow(change.dot(ray), 2);
    EXPECT_LT(change.cross(ray).norm(), 1e-6);
  }
  const auto n = static_cast<double>(scan.points.size());
  expect_sigma(std::sqrt(along / n), 2 * kResolution, scan.points.size());
}

TEST(DegradeScene, MovesAShareOfThePointsIntoTheScansBox) {
  const Cloud scan = bumps(20000);
  const Cloud after = degraded(scan, {.shot_noise = 0.05F});
  Eigen::AlignedBox3f box;
  for (std::size_t i = 0; i < scan.points.size(); ++i) box.extend(scan.points[i]);
  Vector3d mean = Vector3d::Zero();
  double moved = 0;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    EXPECT_TRUE(box.contains(after.points[i]));
    if (after.points[i] == scan.points[i]) continue;
    ++moved;
    mean += ((after.points[i] - box.min()).array() / box.sizes().array()).matrix().cast<double>();
  }
  // Five standard deviations of a binomial, and of the mean of a uniform distribution.
  EXPECT_NEAR(moved, 0.05 * 20000, 5 * std::sqrt(0.05 * 0.95 * 20000));
  for (const double m : (mean / moved).eval()) EXPECT_NEAR(m, 0.5, 5 / std::sqrt(12 * moved));
}

TEST(DegradeScene, KeepsAShareOfThePointsInTheirOrder) {
  const Cloud scan = bumps(20000);
  for (const float share : {0.5F, 0.0625F}) {
    const Cloud after = degraded(scan, {.keep = share});
    const double p = static_cast<double>(share);
    EXPECT_NEAR(static_cast<double>(after.points.size()), p * 20000,
                5 * std::sqrt(p * (1 - p) * 20000));
    std::size_t i = 0;
    for (std::size_t k = 0; k < after.points.size(); ++k, ++i) {
      while (i < scan.points.size() && scan.points[i] != after.points[k]) ++i;
    }
    EXPECT_LE(i, scan.points.size()) << "a point that was not there before";
  }
}

TEST(DegradeScene, SubsamplesByCellsInDiameters) {
  const Cloud scan = bumps(5000);
  constexpr float kCell = 0.4F * kDiameter;
  kernels::SubsampleScratch scratch;
  Points voxels, approximate;
  Column<std::uint32_t> lowest, rest;
  kernels::subsample_voxel_grid(scan.points, kCell, voxels, scratch);
  kernels::subsample_approximate_voxel_grid(scan.points, kCell, approximate);
  kernels::subsample_grid_minimum(scan.points, kCell, lowest, scratch);
  kernels::subsample_local_maximum(scan.points, kCell, rest, scratch);
  const auto by = [&](Subsampler subsampler) {
    return degraded(scan, {.subsampler = subsampler, .cell = 0.4F}).points;
  };
  EXPECT_TRUE(test::same_bits(by(Subsampler::voxel_grid), voxels));
  EXPECT_TRUE(test::same_bits(by(Subsampler::approximate_voxel_grid), approximate));
  EXPECT_TRUE(test::same_bits(by(Subsampler::grid_minimum),
                              test::permuted(scan.points, {lowest.begin(), lowest.end()})));
  EXPECT_TRUE(test::same_bits(by(Subsampler::local_maximum),
                              test::permuted(scan.points, {rest.begin(), rest.end()})));
  EXPECT_LT(voxels.size(), 1000U);
  EXPECT_LT(rest.size(), scan.points.size());
}

TEST(DegradeScene, DegradesOneAfterTheOther) {
  const Cloud scan = wall();
  Cloud step = scan;
  DegradeOptions all;
  for (const DegradeOptions& next :
       std::array<DegradeOptions, 5>{{{.ray_noise = 0.5F},
                                      {.noise_diameters = 0.01F},
                                      {.shot_noise = 0.1F},
                                      {.keep = 0.7F},
                                      {.subsampler = Subsampler::voxel_grid}}}) {
    step = degraded(std::move(step), next);
    all.ray_noise += next.ray_noise;
    all.noise_diameters += next.noise_diameters;
    all.shot_noise += next.shot_noise;
    all.keep *= next.keep;
    all.subsampler = next.subsampler;
    EXPECT_TRUE(test::same_bits(degraded(scan, all).points, step.points));
  }
}

TEST(DegradeScene, DependsOnTheSeedAloneNotOnThreads) {
  const Cloud scan = wall();
  for (const DegradeOptions& options : kEach) {
    const Cloud parallel = degraded(scan, options);
    const ThreadLimit limit(1);
    EXPECT_TRUE(test::same_bits(degraded(scan, options).points, parallel.points));
    const bool is_random = !options.scattered && options.subsampler == Subsampler::none;
    EXPECT_EQ(test::same_bits(degraded(scan, options, 2).points, parallel.points), !is_random);
  }
}

TEST(DegradeScene, BearsCloudsOfFewPoints) {
  for (const std::size_t n : {0, 1, 2}) {
    for (const DegradeOptions& options : kEach)
      EXPECT_LE(degraded(bumps(n), options).points.size(), n);
  }
  Cloud apart = bumps(2);
  apart.grid = PixelGrid{3, 1, {0, PixelGrid::kNone, 1}};
  EXPECT_FALSE(test::same_bits(degraded(apart, {.noise = 1}).points, apart.points))
      << "without adjacent pixels, the points give the resolution";
}

TEST(DegradeScene, RefusesOptionsOutOfRange) {
  EXPECT_TRUE(validate(DegradeOptions{}));
  EXPECT_TRUE(validate(DegradeOptions{true, 10, 1, 10, 1, 1, Subsampler::grid_minimum, 1}));
  const auto refuses = [](const DegradeOptions& options, const std::string& expected) {
    const Result<void> valid = validate(options);
    ASSERT_FALSE(valid) << expected;
    EXPECT_EQ(valid.error().code, ErrorCode::usage);
    EXPECT_NE(valid.error().message.find(expected), std::string::npos) << valid.error().message;
  };
  refuses({.noise = -0.1F}, "noise: expected 0 to 10 [resolution of the scan]");
  refuses({.noise_diameters = 1.1F}, "noise-diameters: expected 0 to 1 [mean diameter]");
  refuses({.ray_noise = 11}, "ray-noise: expected 0 to 10");
  refuses({.shot_noise = std::nanf("")}, "shot-noise: expected 0 to 1");
  refuses({.keep = 0}, "keep: expected above 0 to 1");
  refuses({.cell = 0}, "cell: expected above 0 to 1 [mean diameter]");
}

}  // namespace
}  // namespace trivet
