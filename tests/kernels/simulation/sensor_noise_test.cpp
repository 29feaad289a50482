#include "kernels/simulation/sensor_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace trivet::kernels {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(StructuredLightSigma, HasThePublishedValues) {
  EXPECT_DOUBLE_EQ(structured_light_sigma(0.4, 0), 0.0012);
  EXPECT_DOUBLE_EQ(structured_light_sigma(1.4, 59 * kDegree), 0.0031);
  // At 72 degrees angle / (90 degrees - angle) is 4: the noise grows by 0.1 mm * 16 / sqrt(1).
  EXPECT_NEAR(structured_light_sigma(1, 72 * kDegree), 0.0012 + 0.0019 * 0.36 + 0.0016, 1e-12);
}

TEST(TimeOfFlightSigma, GrowsWithRangeAndOnDarkAndGrazingSurfaces) {
  const auto sigma = [](double range, double cosine, double reflectance) {
    return time_of_flight_sigma(time_of_flight_signal(range, cosine, reflectance));
  };
  EXPECT_DOUBLE_EQ(sigma(1, 1, 1), 0.001);
  EXPECT_DOUBLE_EQ(sigma(3, 1, 1), 0.003);
  EXPECT_DOUBLE_EQ(sigma(1, 0.25, 1), 0.002);
  EXPECT_DOUBLE_EQ(sigma(1, 1, 0.25), 0.002);
}

TEST(StereoSigma, IsTheErrorOfMatchingToFirstOrder) {
  const double f = 600, b = 0.1, z = 0.8;
  EXPECT_DOUBLE_EQ(stereo_sigma(z, f, b), 0.64 * kStereoMatching / 60);
  const double disparity = f * b / z, tiny = 1e-6;
  EXPECT_NEAR((f * b / (disparity - tiny) - z) / tiny, stereo_sigma(z, f, b) / kStereoMatching,
              1e-6);
}

TEST(LaserSigma, IsSomeHundredthsOfAMillimeter) {
  EXPECT_NEAR(laser_sigma(0.5, 0.2), 0.04e-3, 0.002e-3);
  EXPECT_NEAR(laser_sigma(0.7, 0.2), 0.075e-3, 0.002e-3);
  EXPECT_LT(laser_sigma(0.7, 0.3), laser_sigma(0.7, 0.2)) << "a wider angle of triangulation";
}

TEST(QuantizeDisparity, KeepsMultiplesOfTheStepAndRoundsOthers) {
  const double f = 500, b = 0.08;  // disparity 40 / z
  EXPECT_DOUBLE_EQ(quantize_disparity(0.8, f, b, 0.125), 0.8);
  for (const double z : {0.51, 0.77, 1.3, 2.9}) {
    const double step = z * z / (f * b) * 0.125, rounded = quantize_disparity(z, f, b, 0.125);
    EXPECT_LE(std::abs(rounded - z), 0.51 * step);
    EXPECT_NEAR(quantize_disparity(rounded, f, b, 0.125), rounded, 1e-12);
  }
  EXPECT_EQ(quantize_disparity(1e6, f, b, 0.125), std::numeric_limits<double>::infinity());
}

TEST(MirrorAngle, IsTwiceTheTiltOfAMirrorThatFacesLightAndSensor) {
  const Eigen::Vector3d up(0, 0, 1);
  for (const double tilt : {0.0, 0.01, 0.3, 1.0}) {
    EXPECT_NEAR(mirror_angle({std::sin(tilt), 0, std::cos(tilt)}, up, up), 2 * tilt, 1e-12);
  }
  EXPECT_NEAR(
      mirror_angle(up, {std::sin(0.4), 0, std::cos(0.4)}, {std::sin(-0.4), 0, std::cos(0.4)}), 0,
      1e-12);
}

}  // namespace
}  // namespace trivet::kernels
