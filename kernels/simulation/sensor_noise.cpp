#include "kernels/simulation/sensor_noise.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace trivet::kernels {

double structured_light_sigma(double z, double angle) noexcept {
  constexpr double kRightAngle = std::numbers::pi / 2;
  const double facing = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
  if (angle < std::numbers::pi / 3) return facing;
  const double left = kRightAngle - angle;
  return facing + 0.0001 / std::sqrt(z) * angle * angle / (left * left);
}

double time_of_flight_signal(double range, double cosine, double reflectance) noexcept {
  return reflectance * cosine / (range * range);
}

double time_of_flight_sigma(double signal) noexcept { return 0.001 / std::sqrt(signal); }

double stereo_sigma(double z, double focal_pixel, double baseline) noexcept {
  return z * z * kStereoMatching / (focal_pixel * baseline);
}

double laser_sigma(double z, double baseline) noexcept {
  constexpr double kWavelength = 650e-9, kApertureRadius = 0.0035;
  const double sin_aperture = kApertureRadius / std::hypot(kApertureRadius, z),
               sin_triangulation = baseline / std::hypot(baseline, z);
  return kWavelength / (2 * std::numbers::pi * sin_aperture * sin_triangulation);
}

double quantize_disparity(double z, double focal_pixel, double baseline,
                          double step_pixel) noexcept {
  const double disparity = focal_pixel * baseline / z;
  return focal_pixel * baseline / (step_pixel * std::round(disparity / step_pixel));
}

double mirror_angle(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                    const Eigen::Vector3d& to_sensor) noexcept {
  const Eigen::Vector3d mirrored = 2 * normal.dot(to_light) * normal - to_light;
  return std::atan2(mirrored.cross(to_sensor).norm(), mirrored.dot(to_sensor));
}

}  // namespace trivet::kernels
