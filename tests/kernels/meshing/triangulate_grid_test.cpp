#include "kernels/meshing/triangulate_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

#include "support/depth_scan.hpp"
#include "support/random.hpp"
#include "support/reference_mesh.hpp"

namespace trivet::kernels {
namespace {

using Eigen::Vector3f;
using test::depth_scan;
using test::DepthScan;
using test::Random;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

DepthScan facing_plane(std::uint32_t width, std::uint32_t height) {
  return depth_scan(width, height, [](float, float) { return 1.0F; });
}

/// A plane that the line of sight at the image's center meets at this angle to the normal.
DepthScan slanted_plane(float angle_deg) {
  const float slope = std::tan(angle_deg * std::numbers::pi_v<float> / 180);
  return depth_scan(5, 5, [&](float a, float) { return 1 / (1 - slope * a); });
}

/// A wavy sheet with a depth step and holes.
DepthScan rough_scan() {
  Random random;
  return depth_scan(40, 30, [&](float a, float b) {
    if (random.below(10) == 0) return kNaN;
    return 1 + (a > 0.05F ? 0.5F : 0.0F) + 0.1F * b * b + random.uniform(-0.004F, 0.004F);
  });
}

Triangles triangulate(const DepthScan& scan, const GridTriangulationOptions& options = {},
                      GridTriangulationStats* stats = nullptr, float noise = 0,
                      const Vector3f& viewpoint = Vector3f::Zero()) {
  const std::vector<float> everywhere(scan.points.size(), noise);
  return triangulate_grid(scan.grid, scan.points, viewpoint, everywhere, options, stats);
}

/// Triangles with their winding, each from its lowest corner, in ascending order.
std::vector<std::array<std::uint32_t, 3>> sorted(const Triangles& triangles) {
  std::vector<std::array<std::uint32_t, 3>> all;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::array c{triangles.a[t], triangles.b[t], triangles.c[t]};
    std::ranges::rotate(c, std::ranges::min_element(c));
    all.push_back(c);
  }
  std::ranges::sort(all);
  return all;
}

bool all_face(const DepthScan& scan, const Triangles& triangles, const Vector3f& viewpoint) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const Vector3f a = scan.points[triangles.a[t]];
    const Vector3f n = (scan.points[triangles.b[t]] - a).cross(scan.points[triangles.c[t]] - a);
    if (!(n.dot(viewpoint - a) > 0)) return false;
  }
  return true;
}

TEST(TriangulateGrid, SpansTwoTrianglesASquareThatFaceTheSensor) {
  const DepthScan plane = facing_plane(20, 15);
  const Triangles triangles = triangulate(plane);
  EXPECT_EQ(triangles.size(), 2U * 19 * 14);
  EXPECT_TRUE(all_face(plane, triangles, Vector3f::Zero()));
  EXPECT_EQ(reference::count_open_edges(triangles), 2U * (19 + 14));
}

TEST(TriangulateGrid, FacesAViewpointOnTheOtherSideToo) {
  const DepthScan plane = facing_plane(20, 15);
  const Vector3f behind(0, 0, 2);
  const Triangles triangles = triangulate(plane, {}, nullptr, 0, behind);
  EXPECT_EQ(triangles.size(), 2U * 19 * 14);
  EXPECT_TRUE(all_face(plane, triangles, behind));
}

TEST(TriangulateGrid, HasEachEdgeOncePerSideOnRoughScans) {
  const DepthScan rough = rough_scan();
  const Triangles triangles = triangulate(rough);
  EXPECT_GT(triangles.size(), 1000U);
  EXPECT_GT(reference::count_open_edges(triangles),
            0U);  // also fails where a side of an edge has two triangles
  EXPECT_TRUE(all_face(rough, triangles, Vector3f::Zero()));
}

TEST(TriangulateGrid, GivesTheSameSurfaceForAMirroredOrTurnedImage) {
  const DepthScan rough = rough_scan();
  DepthScan mirrored = rough, transposed = rough;
  const std::uint32_t width = rough.grid.width, height = rough.grid.height;
  std::swap(transposed.grid.width, transposed.grid.height);
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      const std::int32_t index = rough.grid.point_index[v * width + u];
      mirrored.grid.point_index[v * width + width - 1 - u] = index;
      transposed.grid.point_index[u * height + v] = index;
    }
  }
  EXPECT_EQ(sorted(triangulate(mirrored)), sorted(triangulate(rough)));
  EXPECT_EQ(sorted(triangulate(transposed)), sorted(triangulate(rough)));
}

TEST(TriangulateGrid, MovesWithTheScan) {
  const DepthScan rough = rough_scan();
  Random random;
  const Pose motion = random.motion();
  DepthScan moved = rough;
  moved.points = test::transformed(rough.points, motion.linear(), motion.translation());
  EXPECT_EQ(sorted(triangulate(moved, {}, nullptr, 0, motion.translation())),
            sorted(triangulate(rough)));
}

TEST(TriangulateGrid, CutsAStepInDepth) {
  const DepthScan step = depth_scan(20, 15, [](float a, float) { return a < 0 ? 1.0F : 1.2F; });
  GridTriangulationStats stats;
  const Triangles triangles = triangulate(step, {}, &stats);
  EXPECT_EQ(triangles.size(), 2U * 18 * 14) << "one column of squares is gone";
  EXPECT_EQ(stats.num_jumps, 2U * 14);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    EXPECT_EQ(step.points[triangles.a[t]].z(), step.points[triangles.b[t]].z());
    EXPECT_EQ(step.points[triangles.b[t]].z(), step.points[triangles.c[t]].z());
  }
}

TEST(TriangulateGrid, JudgesAStepByTheFootprintThere) {
  // The same step is 10 pixel footprints near the sensor and 1 far away.
  const auto two_depths = [](float z) {
    return depth_scan(4, 4, [z](float a, float) { return a < 0 ? z : z + 0.1F; });
  };
  EXPECT_EQ(triangulate(two_depths(1)).size(), 2U * 2 * 3);
  EXPECT_EQ(triangulate(two_depths(10)).size(), 2U * 3 * 3);
}

TEST(TriangulateGrid, DoesNotCutWhatNoiseExplains) {
  Random random;
  const float noise = 5 * test::kPixelPitch;
  const DepthScan noisy = depth_scan(60, 60, [&](float, float) {
    return 1 + std::clamp(random.normal(noise), -2 * noise, 2 * noise);
  });
  const double all = 2.0 * 59 * 59;
  EXPECT_LT(static_cast<double>(triangulate(noisy).size()), 0.5 * all);
  EXPECT_GT(static_cast<double>(triangulate(noisy, {}, nullptr, noise).size()), 0.95 * all);
}

TEST(TriangulateGrid, CutsTrianglesAtTooGrazingAnAngle) {
  const GridTriangulationOptions no_jumps{.max_jump = 1000};
  EXPECT_EQ(triangulate(slanted_plane(70)).size(), 32U);
  EXPECT_EQ(triangulate(slanted_plane(76), no_jumps).size(), 32U);
  GridTriangulationStats stats;
  EXPECT_TRUE(triangulate(slanted_plane(84), no_jumps, &stats).empty());
  EXPECT_EQ(stats.num_grazing, 32U);
  EXPECT_EQ(stats.num_jumps, 0U);
  EXPECT_TRUE(triangulate(slanted_plane(50), {.max_grazing_deg = 40}).empty());
}

TEST(TriangulateGrid, LeavesTheTriangleOfThreeBesideOneThatIsMissingOrFar) {
  const std::size_t all = triangulate(facing_plane(5, 5)).size();
  const auto at_middle = [](float z) {
    int pixel = 0;
    return depth_scan(5, 5, [=](float, float) mutable { return pixel++ == 12 ? z : 1; });
  };
  EXPECT_EQ(triangulate(at_middle(kNaN)).size(), all - 4);
  EXPECT_EQ(triangulate(at_middle(3)).size(), all - 4);
  EXPECT_EQ(triangulate(at_middle(0.5F)).size(), all - 4);

  DepthScan not_finite = facing_plane(5, 5);
  not_finite.points.set(12, {0, kNaN, 1});
  EXPECT_EQ(triangulate(not_finite).size(), all - 4);
}

TEST(TriangulateGrid, LeavesOutTrianglesWithoutAnArea) {
  DepthScan plane = facing_plane(5, 5);
  plane.points.set(12, plane.points[11]);
  const Triangles triangles = triangulate(plane);
  EXPECT_EQ(triangles.size(), 30U);
  EXPECT_TRUE(all_face(plane, triangles, Vector3f::Zero()));
}

TEST(TriangulateGrid, CountsTrianglesThatFaceAway) {
  // A sheet that folds back over itself, which no sensor at the origin could see.
  DepthScan folded = facing_plane(9, 3);
  for (std::size_t i = 0; i < folded.points.size(); ++i) {
    const std::size_t u = i % 9;
    if (u > 6) folded.points.set(i, folded.points[i - 2 * (u - 6)] + Vector3f(0, 0, 0.02F));
  }
  GridTriangulationStats stats;
  const Triangles triangles = triangulate(folded, {}, &stats);
  EXPECT_EQ(triangles.size() + stats.num_behind + stats.num_jumps + stats.num_grazing, 32U);
  EXPECT_EQ(stats.num_behind, 4U + 4U);
  EXPECT_TRUE(all_face(folded, triangles, Vector3f::Zero()));
}

TEST(TriangulateGrid, AcceptsImagesWithoutASquare) {
  for (const auto& [width, height] : {std::pair{0U, 0U}, {1U, 1U}, {1U, 5U}, {5U, 1U}})
    EXPECT_TRUE(triangulate(facing_plane(width, height)).empty());
  EXPECT_EQ(triangulate(facing_plane(2, 2)).size(), 2U);
  EXPECT_TRUE(triangulate(depth_scan(6, 6, [](float, float) { return kNaN; })).empty());
}

}  // namespace
}  // namespace trivet::kernels
