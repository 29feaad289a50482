/// Simulated measurements of four kinds of depth sensors, from exactly known surfaces.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "engine/options/option.hpp"
#include "engine/simulation/sensor_flaws.hpp"
#include "kernels/common/ray_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet {

enum class Sensor { structured_light, time_of_flight, stereo, laser };

struct SensorOptions {
  Sensor sensor = Sensor::structured_light;
  float noise = 1;  ///< factor on the standard deviation of the noise law; 0: no noise
  /// Disparity step of the quantization; 0: none; absent: the sensor's own.
  std::optional<float> disparity_step_pixel{};
  bool operator==(const SensorOptions&) const = default;
};

template <>
std::span<const Choice> choices_of<Sensor>();

namespace engine {

struct SensorTraits {
  double baseline;  ///< distance from the camera to the light or the second camera, along x [m]
  double disparity_step;     ///< [pixel]; 0: none
  double depth_step;         ///< depth step of the 16-bit image [m]
  double nearest, farthest;  ///< range of the sensor [m]
};
const SensorTraits& traits_of(Sensor sensor);

/// Image of an ideal camera, from kernels::render_depth.
struct ExactImage {
  explicit ExactImage(std::uint32_t image_width, std::uint32_t image_height);
  std::uint32_t width, height;
  std::vector<float> depth;             ///< [m]; 0: no surface
  std::vector<std::uint32_t> instance;  ///< kernels::Hit::kNone: no surface
  Normals normals;                      ///< toward the camera
};
ExactImage render_exactly(const kernels::RayScene& rays, const Camera& camera, std::uint32_t width,
                          std::uint32_t height);

/// Whether there is a depth step between a pixel with a surface and an adjacent one.
bool at_edge(const ExactImage& image, const Camera& camera, std::size_t i);

/// Reflection properties of a surface.
struct Finish {
  bool metal = false;        ///< whether it mirrors
  double reflectance = 0.5;  ///< diffuse reflectance, 0..1
};

/// Factor of the noise due to mirrored light: 1 for surfaces that do not mirror; infinite: no
/// measurement possible. All vectors have unit length and point away from the surface.
double glare(const Finish& finish, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
             const Eigen::Vector3d& to_camera);

/// A scene for a sensor. Keeps references to all members.
struct ExactScene {
  const kernels::RayScene& rays;     ///< in the camera's frame [m]
  const Camera& camera;              ///< pinhole
  const ExactImage& image;           ///< rendered from both by render_exactly
  std::span<const Finish> finishes;  ///< one per instance
};

/// Rays from a light to visible surfaces end before them by this share of their length.
inline constexpr double kBeforeSurface = 3e-4;

/// Measure a scene.
///
/// seed, stream  determine the noise, which is independent for each pixel
/// flaws         flaws of the sensor; without any, the rules below apply. With a matching window,
///               depth is computed by matching (engine/simulation/match_scene); echoes are mixed
///               and bounced (engine/simulation/echo_scene); written values contain the
///               calibration error
/// Returns depths in units of the sensor's depth_step, 0 for no measurement.
///
/// No measurement is possible beyond nearest and farthest; on surfaces steeper than 80 degrees to
/// the camera, the projector, the laser or the second camera, or occluded from them; on both sides
/// of a depth edge; on metal that reflects the light into the camera (within 5 degrees; within 10,
/// the noise is five times as strong). A time-of-flight camera, with its light at the lens,
/// measures edges as the mean over the pixel, weighted by the light, so that they float between the
/// surfaces. It cannot measure surfaces that reflect too little light.
/// Noise: kernels/simulation/sensor_noise.hpp. Same bytes for any number of threads.
std::vector<std::uint16_t> measure_scene(const ExactScene& scene, const SensorOptions& options,
                                         std::uint64_t seed, std::uint64_t stream,
                                         const SensorFlaws& flaws = {});

}  // namespace engine
}  // namespace trivet
