#include "kernels/simulation/deform_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Points throughout a cube of two diameters, in which every wave passes through all its phases.
Points cube(std::size_t n) {
  test::Random random(1);
  Points points;
  for (std::size_t i = 0; i < n; ++i)
    points.push_back({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
  return points;
}

double rms_between(const Points& a, const Points& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    sum += static_cast<double>((a[i] - b[i]).squaredNorm());
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(DeformSurface, MovesPointsByWhatWasAsked) {
  const Points before = cube(5000);
  double sum = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Points after = before;
    deform_surface(after, 1, 0.01, seed);
    sum += rms_between(before, after);
  }
  EXPECT_NEAR(sum / 20, 0.01, 0.001);
}

TEST(DeformSurface, IsSmooth) {
  Points near;
  for (int i = 0; i < 100; ++i) near.push_back({static_cast<float>(i) * 0.001F, 0, 0});
  Points after = near;
  deform_surface(after, 1, 0.01, 7);
  for (std::size_t i = 1; i < near.size(); ++i) {
    const Eigen::Vector3f step = (after[i] - near[i]) - (after[i - 1] - near[i - 1]);
    // The slope is greatest where all six waves rise at once: height 0.0058 times 2 pi / 0.4 each.
    EXPECT_LT(step.norm(), 6 * 0.0058 * 2 * 3.1416 / 0.4 * 0.001);
  }
}

TEST(DeformSurface, GrowsWithTheBody) {
  Points small = cube(100), large = small;
  for (std::size_t i = 0; i < large.size(); ++i) large.set(i, 8 * large[i]);
  deform_surface(small, 1, 0.01, 3);
  deform_surface(large, 8, 0.08, 3);
  for (std::size_t i = 0; i < small.size(); ++i) EXPECT_LT((large[i] - 8 * small[i]).norm(), 1e-5F);
}

TEST(DeformSurface, GivesOneFieldASeed) {
  Points a = cube(100), b = a, c = a, still = a;
  deform_surface(a, 1, 0.01, 3);
  deform_surface(b, 1, 0.01, 3);
  deform_surface(c, 1, 0.01, 4);
  EXPECT_EQ(rms_between(a, b), 0);
  EXPECT_GT(rms_between(a, c), 0.005);
  deform_surface(still, 1, 0, 3);
  EXPECT_EQ(rms_between(still, cube(100)), 0);
}

}  // namespace
}  // namespace trivet::kernels
