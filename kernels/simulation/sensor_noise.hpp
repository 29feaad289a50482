/// Error laws of depth sensors, one per function; all lengths in meters.
#pragma once

#include <Eigen/Core>

namespace trivet::kernels {

/// Standard deviation of depth of a structured-light camera like the Kinect.
///
/// z      depth > 0 [m]
/// angle  between the surface's normal and the ray [rad], 0 .. pi / 2
/// Source: Nguyen, Izadi, Lovell, "Modeling Kinect sensor noise for improved 3D reconstruction and
/// tracking", 3DIMPVT 2012: 1.2 mm + 1.9 mm (z - 0.4)^2, and from 60 degrees on 0.1 mm / sqrt(z)
/// angle^2 / (pi / 2 - angle)^2 more.
double structured_light_sigma(double z, double angle) noexcept;

/// Share of the light that returns to a time-of-flight camera, 1 for a white surface that faces it
/// from 1 m: reflectance cos(angle) / range^2 (Lambert).
double time_of_flight_signal(double range, double cosine, double reflectance) noexcept;

/// Standard deviation of the range along the ray, limited by shot noise: 1 mm / sqrt(signal), which
/// is proportional to the range. Source: Lange, Seitz, "Solid-state time-of-flight range camera",
/// IEEE J. Quantum Electronics 37(3), 2001: inverse to the root of the number of photons.
double time_of_flight_sigma(double signal) noexcept;

/// Standard deviation of depth of a stereo camera, z^2 sigma_d / (f b) for a matching error of
/// kStereoMatching pixels. Source: first-order error of z = f b / d.
double stereo_sigma(double z, double focal_pixel, double baseline) noexcept;
inline constexpr double kStereoMatching = 0.1;

/// Standard deviation of depth of a laser line scanner, limited by speckle: lambda / (2 pi sin u
/// sin t) with 650 nm, the lens' aperture u from a radius of 3.5 mm, and the angle of triangulation
/// t. About 0.04 mm at 0.5 m and 0.08 mm at 0.7 m for a baseline of 0.2 m. Source: Dorsch,
/// Haeusler, Herrmann, "Laser triangulation: fundamental uncertainty in distance measurement",
/// Applied Optics 33(7), 1994.
double laser_sigma(double z, double baseline) noexcept;

/// Depth of the disparity f b / z rounded to steps. Infinite for less than half a step.
double quantize_disparity(double z, double focal_pixel, double baseline,
                          double step_pixel) noexcept;

/// Angle [rad] between the direction of mirror reflection and the direction to the sensor.
///
/// normal, to_light, to_sensor  unit vectors from the surface
double mirror_angle(const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                    const Eigen::Vector3d& to_sensor) noexcept;

}  // namespace trivet::kernels
