#include "kernels/simulation/noise_field.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/allocations.hpp"

namespace trivet::kernels {
namespace {

constexpr std::uint32_t kWidth = 400, kHeight = 300;

/// Mean product of values at this separation, over many fields.
double correlation(double length, double apart) {
  double sum = 0, n = 0;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const NoiseField field(kWidth, kHeight, length, seed, 3, 9);
    for (double v = 0; v < kHeight; v += 1.7) {
      for (double u = 0; u + apart < kWidth; u += 1.7) {
        sum += field.at(u, v) * field.at(u + apart, v);
        n += 1;
      }
    }
  }
  return sum / n;
}

// Interpolation by cubic B-splines of white noise has, along an axis, the autocorrelation of the
// spline with itself, the B-spline of degree 7: 1191 / 2416 at one knot, 120 / 2416 at two.
TEST(NoiseField, HasUnitVarianceAndTheSplinesAutocorrelation) {
  for (const double length : {4.0, 9.0, 16.0}) {
    EXPECT_NEAR(correlation(length, 0), 1, 0.1) << length;
    EXPECT_NEAR(correlation(length, length / 2), 1191.0 / 2416, 0.1) << length;
    EXPECT_NEAR(correlation(length, length), 120.0 / 2416, 0.1) << length;
  }
}

TEST(NoiseField, DependsOnItsSeedAndThePlaceAlone) {
  const NoiseField small(50, 40, 8, 1, 2, 3), again(50, 40, 8, 1, 2, 3), other(50, 40, 8, 2, 2, 3);
  EXPECT_EQ(small.at(31, 17), again.at(31, 17));
  EXPECT_NE(small.at(31, 17), other.at(31, 17));
}

TEST(NoiseField, AllocatesNothingWhenSampled) {
  const NoiseField field(kWidth, kHeight, 8, 1, 2, 3);
  double sum = 0;
  EXPECT_EQ(test::allocations_in([&] { sum = field.at(kWidth - 1, kHeight - 1); }), 0U);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace trivet::kernels
