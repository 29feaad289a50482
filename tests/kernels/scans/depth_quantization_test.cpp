#include "kernels/scans/depth_quantization.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "support/random.hpp"

namespace trivet::kernels {
namespace {

/// Depths of a slanted surface from 0.5 to 0.7.
std::vector<float> slope() {
  std::vector<float> depths;
  for (int i = 0; i < 4000; ++i) depths.push_back(0.5F + 0.2F * static_cast<float>(i) / 4000);
  return depths;
}

TEST(DepthQuantization, IsThatOfWholeMillimeters) {
  for (const float step : {0.0002F, 0.001F, 0.005F}) {
    std::vector<float> depths = slope();
    for (float& d : depths) d = std::round(d / step) * step;
    test::Random random;
    for (float& d : depths) d *= 1 + random.uniform(-1e-7F, 1e-7F);  // moved there and back
    EXPECT_NEAR(quantization_step(depths), step, 0.01F * step);
  }
}

TEST(DepthQuantization, IsThatOfDisparitiesAtTheMedianRange) {
  constexpr float kFocalTimesBase = 575 * 0.075F, kDisparityStep = 0.125F;
  std::vector<float> depths = slope();
  for (float& d : depths) {
    const float disparity = kFocalTimesBase / d;
    d = kFocalTimesBase / (std::round(disparity / kDisparityStep) * kDisparityStep);
  }
  const float expected = 0.6F * 0.6F * kDisparityStep / kFocalTimesBase;
  EXPECT_NEAR(quantization_step(depths), expected, 0.1F * expected);
}

TEST(DepthQuantization, IsNoneOfContinuousDepthsAndOfFewSurfaces) {
  std::vector<float> depths = slope();
  EXPECT_EQ(quantization_step(depths), 0);
  std::vector<float> two_walls(1000, 0.6F);
  std::fill_n(two_walls.begin(), 300, 0.58F);
  EXPECT_EQ(quantization_step(two_walls), 0) << "a sensor without noise";
  EXPECT_EQ(quantization_step({}), 0);
}

TEST(DepthQuantization, DependsOnNoOrderAndGrowsWithTheUnit) {
  std::vector<float> depths = slope();
  for (float& d : depths) d = std::round(d * 512) / 512;
  std::vector<float> shuffled = depths, doubled = depths;
  std::shuffle(shuffled.begin(), shuffled.end(), std::mt19937(5));
  for (float& d : doubled) d *= 2;
  const float step = quantization_step(depths);
  EXPECT_EQ(step, 1.0F / 512);
  EXPECT_EQ(quantization_step(shuffled), step);
  EXPECT_EQ(quantization_step(doubled), 2 * step);
}

TEST(DepthQuantization, IsWhatRoundingErrsByOnAverage) {
  test::Random random;
  double squares = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const double d = static_cast<double>(random.uniform(0, 100)), error = std::round(d) - d;
    squares += error * error;
  }
  EXPECT_NEAR(static_cast<double>(quantization_error(1)), std::sqrt(squares / kCount), 0.005);
}

}  // namespace
}  // namespace trivet::kernels
