#include "kernels/scans/depth_steps.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/random.hpp"
#include "support/rendered_bodies.hpp"
#include "support/smoothed_image.hpp"

namespace trivet::kernels {
namespace {

using test::Body;

/// A plate 20 mm before a wall that is 0.6 m away, at most 3.3 % of the range.
RangeImage plate() {
  static const Body body({0.1F, 0.07F, 0.01F});
  return test::render({{&body, test::pose_of({0, 0, 0.1F}, {0, 0, 0.59F})}}, 0.6F);
}

StepCounts count(const RangeImage& image) {
  StepCounts counts = count_steps_of_rows(image, 0, image.geometry.height);
  counts += count_steps_of_columns(image, 0, image.geometry.width);
  return counts;
}

TEST(DepthSteps, OfAnUnfilteredImageAreAbrupt) {
  const StepCounts counts = count(plate());
  EXPECT_GT(counts.steps, 120U);
  EXPECT_EQ(counts.abrupt, counts.steps);
}

TEST(DepthSteps, OfASmoothedImageAreNot) {
  for (const double length : {2.0, 4.0}) {
    const StepCounts counts = count(test::smoothed(plate(), length));
    EXPECT_GT(counts.steps, 60U) << length;
    EXPECT_EQ(counts.abrupt, 0U) << length;
  }
}

/// Whether the depth of a pixel is another than that of its left or upper neighbor.
bool is_beside_edge(const RangeImage& image, std::size_t pixel) {
  const std::size_t width = image.geometry.width;
  const auto differs = [&](std::size_t other) {
    return std::abs(image.depth[pixel] - image.depth[other]) > 0.01F;
  };
  return (pixel % width > 0 && differs(pixel - 1)) || (pixel >= width && differs(pixel - width));
}

TEST(DepthSteps, AreAbruptWhereSensorsLoseThePixelsOfEdges) {
  const RangeImage whole = plate();
  RangeImage image = whole;
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    if (is_beside_edge(whole, pixel)) image.depth[pixel] = 0;
  }
  const StepCounts counts = count(image);
  EXPECT_GT(counts.steps, 120U);
  EXPECT_EQ(counts.abrupt, counts.steps);
}

TEST(DepthSteps, HaveNoWideGaps) {
  const RangeImage image = plate(), blurred = test::smoothed(image, 2);
  RangeImage open = blurred;
  for (std::size_t pixel = 0; pixel < image.depth.size(); ++pixel) {
    const float moved = blurred.depth[pixel] - image.depth[pixel];
    if (std::abs(moved) > 0.0015F) open.depth[pixel] = 0;  // nothing is measured near edges
  }
  EXPECT_EQ(count(open).steps, 0U);
}

TEST(DepthSteps, AreNeitherSmallNorLargeNorSlopes) {
  const auto at_wall = [](float behind) {
    static const Body body({0.1F, 0.07F, 0.01F});
    return count(test::render({{&body, test::pose_of({0, 0, 0}, {0, 0, 0.59F})}}, 0.58F + behind));
  };
  EXPECT_EQ(at_wall(0.004F).steps, 0U);
  EXPECT_GT(at_wall(0.02F).steps, 0U);
  EXPECT_EQ(at_wall(0.05F).steps, 0U);
  RangeImage slope = plate();
  for (std::size_t pixel = 0; pixel < slope.depth.size(); ++pixel)
    slope.depth[pixel] = 0.5F + 0.001F * static_cast<float>(pixel % slope.geometry.width);
  EXPECT_EQ(count(slope).steps, 0U);
}

TEST(DepthSteps, AddUpOverAnyChunks) {
  RangeImage image = test::smoothed(plate(), 2);
  test::Random random;
  for (float& d : image.depth) d = random.below(20) == 0 ? 0 : d + random.normal(1e-4F);
  const StepCounts all = count(image);
  StepCounts parts;
  for (std::size_t v = 0; v < image.geometry.height; v += 7)
    parts += count_steps_of_rows(image, v, std::min<std::size_t>(7, image.geometry.height - v));
  for (std::size_t u = 0; u < image.geometry.width; ++u)
    parts += count_steps_of_columns(image, u, 1);
  EXPECT_EQ(parts.steps, all.steps);
  EXPECT_EQ(parts.abrupt, all.abrupt);
}

}  // namespace
}  // namespace trivet::kernels
