#include "kernels/common/fast_angle.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace trivet::kernels {
namespace {

double error_at(float y, float x) {
  return std::abs(static_cast<double>(fast_atan2(y, x)) -
                  std::atan2(static_cast<double>(y), static_cast<double>(x)));
}

TEST(FastAngle, IsWithinAMillionthOfARadianAllRound) {
  double worst = 0;
  for (const double radius : {1e-30, 1e-6, 1.0, 3e4, 1e30}) {
    for (int i = 0; i < 100'000; ++i) {
      const double angle = 2e-5 * 3.14159265358979 * (i + 0.5);
      worst = std::max(worst, error_at(static_cast<float>(radius * std::sin(angle)),
                                       static_cast<float>(radius * std::cos(angle))));
    }
  }
  EXPECT_LT(worst, 1e-6);
}

// A grid of integers contains the axes, the diagonals and zeros of both arguments.
TEST(FastAngle, IsWithinAMillionthOfARadianOnAGrid) {
  for (int y = -40; y <= 40; ++y) {
    for (int x = -40; x <= 40; ++x) {
      EXPECT_LT(error_at(static_cast<float>(y), static_cast<float>(x)), 1e-6) << y << ' ' << x;
    }
  }
}

TEST(FastAngle, IsExactOnTheAxesAndZeroAtTheOrigin) {
  for (const float r : {1e-30F, 1.0F, 1e30F}) {
    EXPECT_EQ(fast_atan2(0, r), 0);
    EXPECT_EQ(fast_atan2(r, 0), 0.5F * std::numbers::pi_v<float>);
    EXPECT_EQ(fast_atan2(0, -r), std::numbers::pi_v<float>);
    EXPECT_EQ(fast_atan2(-r, 0), -0.5F * std::numbers::pi_v<float>);
  }
  EXPECT_EQ(fast_atan2(0, 0), 0);
  EXPECT_EQ(fast_atan2(-0.0F, -0.0F), 0);
}

// The quantized angles rely on this: no angle lies beyond the last bin.
TEST(FastAngle, StaysWithinHalfATurn) {
  for (int i = 0; i < 1000; ++i) {
    const float y = std::ldexp(1.0F, -i / 10);
    EXPECT_LE(fast_atan2(y, -1), std::numbers::pi_v<float>);
    EXPECT_GE(fast_atan2(-y, -1), -std::numbers::pi_v<float>);
    EXPECT_GE(fast_atan2(y, 1), 0);
  }
}

}  // namespace
}  // namespace trivet::kernels
