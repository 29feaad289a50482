#include "kernels/scans/estimate_normals_grid.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "support/allocations.hpp"
#include "support/depth_scan.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"

namespace trivet::kernels {
namespace {

using test::depth_scan;
using test::DepthScan;
using test::Random;

// A slanted, noisy sheet with a depth step and holes.
DepthScan rough_scan(std::uint32_t width, std::uint32_t height) {
  Random random(width);
  return depth_scan(width, height, [&](float a, float b) {
    if (random.below(10) == 0) return std::numeric_limits<float>::quiet_NaN();
    return 1 + a + (a > 0.05F ? 0.5F : 0.0F) + 0.1F * b * b + random.normal(0.001F);
  });
}

struct Estimate {
  Normals normals;
  Column<float> residuals;
};

Estimate estimate(const DepthScan& scan, const GridNormalOptions& options = {},
                  const Eigen::Vector3f& viewpoint = {0, 0, 0}, std::size_t grain = 1000) {
  const std::size_t n = scan.points.size();
  Estimate out{Normals(n), Column<float>(n)};
  PixelPoints pixels;
  arrange_pixels(scan.grid, scan.points, pixels);
  test::for_chunks(scan.grid.height, grain, [&](std::size_t first, std::size_t count) {
    estimate_normals_grid({scan.grid, pixels, viewpoint}, options, first, count, out.normals,
                          out.residuals);
  });
  return out;
}

struct Reference {
  std::optional<reference::Plane> plane;  // faces the viewpoint
  bool near_a_limit = false;              // float and double may decide differently
};

Reference reference_normal(const DepthScan& scan, int u, int v, const GridNormalOptions& options) {
  const auto point = [&](int i, int j) -> std::optional<Eigen::Vector3d> {
    if (i < 0 || j < 0 || i >= static_cast<int>(scan.grid.width) ||
        j >= static_cast<int>(scan.grid.height)) {
      return std::nullopt;
    }
    const int at = scan.grid.point_index[static_cast<std::size_t>(j) * scan.grid.width +
                                         static_cast<std::size_t>(i)];
    if (at == PixelGrid::kNone) return std::nullopt;
    return scan.points[static_cast<std::size_t>(at)].cast<double>();
  };
  const Eigen::Vector3d center = *point(u, v);
  const auto distance = [&](int i, int j) {
    const auto p = point(i, j);
    return p ? (*p - center).norm() : std::numeric_limits<double>::infinity();
  };
  const double h = std::min(distance(u - 1, v), distance(u + 1, v));
  const double w = std::min(distance(u, v - 1), distance(u, v + 1));
  if (std::isinf(h) && std::isinf(w)) return {};
  const double footprint =
      std::isinf(std::max(h, w)) ? std::min(h, w) : std::min(std::max(h, w), 3 * std::min(h, w));
  const int window = static_cast<int>(options.window);
  const double gate = double{options.gate} * window * footprint;
  Reference out;
  std::vector<Eigen::Vector3d> used;
  for (int j = v - window; j <= v + window; ++j) {
    for (int i = u - window; i <= u + window; ++i) {
      if (distance(i, j) <= gate) used.push_back(*point(i, j));
      if (std::abs(distance(i, j) - gate) < 1e-5 * gate) out.near_a_limit = true;
    }
  }
  if (used.size() < options.min_points) return out;
  out.plane = reference::fit_plane(used);
  if (!out.plane) return out;
  const double cosine = out.plane->normal.dot(-center.normalized());
  const double limit = std::cos(options.max_obliquity_rad);
  if (std::abs(std::abs(cosine) - limit) < 1e-3) out.near_a_limit = true;
  if (cosine < 0) out.plane->normal *= -1;
  if (std::abs(cosine) < limit) out.plane.reset();
  return out;
}

TEST(EstimateNormalsGrid, AgreesWithReferenceOnRoughScans) {
  for (const auto& [width, height] :
       {std::pair{1U, 1U}, {2U, 1U}, {3U, 3U}, {7U, 5U}, {8U, 8U}, {9U, 20U}, {40U, 30U}}) {
    const DepthScan s = rough_scan(width, height);
    for (const std::uint32_t window : {1U, 2U, 3U, 20U}) {
      const GridNormalOptions options{.window = window};
      const Estimate found = estimate(s, options);
      std::size_t num_compared = 0;
      for (std::uint32_t v = 0; v < height; ++v) {
        for (std::uint32_t u = 0; u < width; ++u) {
          const int at = s.grid.point_index[v * width + u];
          if (at == PixelGrid::kNone) continue;
          const auto i = static_cast<std::size_t>(at);
          const auto expected =
              reference_normal(s, static_cast<int>(u), static_cast<int>(v), options);
          if (expected.near_a_limit) continue;
          ++num_compared;
          SCOPED_TRACE(testing::Message() << width << "x" << height << " window " << window
                                          << " pixel " << u << "," << v);
          ASSERT_EQ(std::isnan(found.normals[i].x()), !expected.plane);
          ASSERT_EQ(std::isnan(found.residuals[i]), !expected.plane);
          if (!expected.plane) continue;
          // The bound: sums over up to 441 floats, 441 * 6e-8 of the widest spread, relative to the
          // noise of 1e-3.
          const Eigen::Vector3d n = found.normals[i].cast<double>();
          ASSERT_LT((n - expected.plane->normal).norm(), 3e-4);
          ASSERT_NEAR(found.residuals[i], expected.plane->residual, 3e-6);
        }
      }
      EXPECT_GE(num_compared, s.points.size() * 9 / 10);
    }
  }
}

TEST(EstimateNormalsGrid, IsTheNormalOfASlantedPlane) {
  const Eigen::Vector3d normal = Eigen::Vector3d(0.6, -0.3, -1).normalized();
  const DepthScan s =
      depth_scan(50, 40, [](float a, float b) { return 1 / (1 - 0.6F * a + 0.3F * b); });
  const Estimate found = estimate(s);
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    ASSERT_LT((found.normals[i].cast<double>() - normal).norm(), 1e-4);
    ASSERT_LT(found.residuals[i], 2e-5);  // square root of float rounding, times the window
  }
}

TEST(EstimateNormalsGrid, NeverBlendsAcrossAStepInDepth) {
  // Two walls that face the camera, one behind the other: blending them would tilt a normal.
  const DepthScan s = depth_scan(60, 40, [](float a, float) { return a < 0 ? 1.0F : 1.2F; });
  for (const std::uint32_t window : {1U, 2U, 3U}) {
    const Estimate found = estimate(s, {.window = window, .min_points = 3});
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      ASSERT_LT((found.normals[i] - Eigen::Vector3f(0, 0, -1)).norm(), 1e-4) << "point " << i;
    }
  }
}

TEST(EstimateNormalsGrid, UsesTheFullWindowOfASlantedSurface) {
  // At 60 degrees the farthest of the 49 pixels is 2.2 times as far as on a frontal surface.
  const float slope = std::tan(1.0472F);
  const DepthScan s = depth_scan(40, 30, [&](float a, float) { return 1 / (1 - slope * a); });
  const Estimate found = estimate(s, {.window = 3, .min_points = 49});
  for (int v = 10; v < 20; ++v) {
    for (int u = 10; u < 30; ++u) {
      const auto i = static_cast<std::size_t>(v * 40 + u);
      EXPECT_FALSE(std::isnan(found.normals[i].x())) << u << "," << v;
    }
  }
}

TEST(EstimateNormalsGrid, FacesTheViewpoint) {
  const DepthScan s = rough_scan(40, 30);
  for (const Eigen::Vector3f& viewpoint : {Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0, 0, 9)}) {
    const Estimate found = estimate(s, {}, viewpoint);
    for (std::size_t i = 0; i < s.points.size(); ++i) {
      if (std::isnan(found.normals[i].x())) continue;
      ASSERT_GE(found.normals[i].dot(viewpoint - s.points[i]), 0);
    }
  }
}

TEST(EstimateNormalsGrid, GivesNaNForObliqueSurfaces) {
  const DepthScan s =
      depth_scan(20, 20, [](float a, float) { return 1 / (1 - 3 * a); });  // about 72 degrees
  const Estimate strict = estimate(s, {.max_obliquity_rad = 0.8F});
  const Estimate lenient = estimate(s, {.max_obliquity_rad = 1.5F});
  EXPECT_TRUE(std::isnan(strict.normals[210].x()));
  EXPECT_TRUE(std::isnan(strict.residuals[210]));
  EXPECT_FALSE(std::isnan(lenient.normals[210].x()));
}

TEST(EstimateNormalsGrid, GivesNaNForPixelsAlone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  int pixel = 0;
  const DepthScan checkers =
      depth_scan(9, 9, [&](float, float) { return pixel++ % 2 == 0 ? 1.0F : nan; });
  const Estimate found = estimate(checkers);
  for (std::size_t i = 0; i < checkers.points.size(); ++i) {
    EXPECT_TRUE(std::isnan(found.normals[i].x()));
  }
}

TEST(EstimateNormalsGrid, GrowsWithTheUnit) {
  DepthScan s = rough_scan(40, 30);
  const Estimate meters = estimate(s);
  s.points = test::transformed(s.points, 1024 * Eigen::Matrix3f::Identity(), {0, 0, 0});
  const Estimate larger = estimate(s);
  EXPECT_TRUE(test::same_bits(larger.normals, meters.normals));
  for (std::size_t i = 0; i < s.points.size(); ++i) {
    if (!std::isnan(meters.residuals[i])) {
      ASSERT_EQ(larger.residuals[i], 1024 * meters.residuals[i]);
    }
  }
}

TEST(EstimateNormalsGrid, GivesTheSameBitsForAnyChunking) {
  const DepthScan s = rough_scan(40, 30);
  const Estimate whole = estimate(s);
  for (const std::size_t grain : {1U, 7U, 29U}) {
    const Estimate chunked = estimate(s, {}, {0, 0, 0}, grain);
    EXPECT_TRUE(test::same_bits(chunked.normals, whole.normals));
    EXPECT_TRUE(test::same_bits(chunked.residuals, whole.residuals));
  }
}

TEST(EstimateNormalsGrid, AllocatesNothing) {
  const DepthScan s = rough_scan(40, 30);
  Normals normals(s.points.size());
  PixelPoints pixels;
  arrange_pixels(s.grid, s.points, pixels);
  EXPECT_EQ(test::allocations_in([&] {
              arrange_pixels(s.grid, s.points, pixels);
              estimate_normals_grid({s.grid, pixels, {0, 0, 0}}, {}, 0, 30, normals);
            }),
            0U);
}

TEST(EstimateScanNoise, FindsTheNoiseDespiteEdgesAndCurves) {
  for (const float noise : {0.0005F, 0.002F}) {
    Random random;
    const DepthScan s = depth_scan(120, 100, [&](float a, float b) {
      const float ball = a * a + b * b < 0.04F ? 0.3F * std::sqrt(0.04F - a * a - b * b) : 0.0F;
      return 1 - ball + (a > 0.3F ? 0.4F : 0.0F) + random.normal(noise);
    });
    const Estimate found = estimate(s, {.window = 2});
    Column<float> scratch;
    EXPECT_NEAR(estimate_scan_noise(found.residuals, scratch), noise, 0.1F * noise);
  }
}

TEST(EstimateScanNoise, IsZeroWithoutResiduals) {
  Column<float> scratch;
  const std::vector<float> none(3, std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(estimate_scan_noise({}, scratch), 0);
  EXPECT_EQ(estimate_scan_noise(none, scratch), 0);
}

}  // namespace
}  // namespace trivet::kernels
