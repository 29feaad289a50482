/// What depth sensors of four kinds make of surfaces that are known exactly.
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
  float noise = 1;  ///< multiplies the law's standard deviation; 0: none
  /// Depth is told in such steps of disparity; 0: not; absent: the sensor's own.
  std::optional<float> disparity_step_pixel{};
  bool operator==(const SensorOptions&) const = default;
};

template <>
std::span<const Choice> choices_of<Sensor>();

namespace engine {

struct SensorTraits {
  double baseline;           ///< [m] from the camera to the light or the second camera, along x
  double disparity_step;     ///< [pixel]; 0: none
  double depth_step;         ///< [m], of the 16-bit image
  double nearest, farthest;  ///< [m] that can be measured
};
const SensorTraits& traits_of(Sensor sensor);

/// What an ideal camera sees, as of kernels::render_depth.
struct ExactImage {
  explicit ExactImage(std::uint32_t image_width, std::uint32_t image_height);
  std::uint32_t width, height;
  std::vector<float> depth;             ///< [m]; 0: nothing there
  std::vector<std::uint32_t> instance;  ///< kernels::Hit::kNone: nothing there
  Normals normals;                      ///< towards the camera
};
ExactImage render_exactly(const kernels::RayScene& rays, const Camera& camera, std::uint32_t width,
                          std::uint32_t height);

/// Whether depth jumps from a pixel that sees something to one beside it.
bool at_edge(const ExactImage& image, const Camera& camera, std::size_t i);

/// How a surface throws light back.
struct Finish {
  bool metal = false;        ///< mirrors
  double reflectance = 0.5;  ///< of diffuse light, 0..1
};

/// How much stronger the noise is by mirrored light: 1 for surfaces that do not mirror; infinite:
/// nothing can be measured. All vectors of unit length, from the surface.
double glare(const Finish& finish, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
             const Eigen::Vector3d& to_camera);

/// A scene that a sensor measures. All are referred to.
struct ExactScene {
  const kernels::RayScene& rays;     ///< in the camera's frame [m]
  const Camera& camera;              ///< pinhole
  const ExactImage& image;           ///< render_exactly of both
  std::span<const Finish> finishes;  ///< one an instance
};

/// Rays from a light to what the camera sees end so much of their length before it.
inline constexpr double kBeforeSurface = 3e-4;

/// Measure a scene.
///
/// seed, stream  give the noise: each pixel has its own
/// flaws         none: what follows. With a window, depth is matched
///               (engine/simulation/match_scene); light that comes back is mixed and bounced
///               (engine/simulation/echo_scene); what is written is wrong by the calibration
/// Returns depths in the sensor's depth_step, 0 for no measurement.
///
/// No measurement: beyond nearest and farthest; surfaces steeper than 80 degrees to the camera, to
/// the projector, to the laser or to the second camera, or hidden from those; both sides of a depth
/// edge; metal that throws the light into the camera (to 5 degrees; to 10, the noise is five times
/// as strong). A time-of-flight camera, with its light at the lens, measures edges as the mean over
/// the pixel, weighted by the light, so that they float between the surfaces, and loses surfaces
/// that throw too little light back.
/// Noise: kernels/simulation/sensor_noise.hpp. Same bytes for any number of threads.
std::vector<std::uint16_t> measure_scene(const ExactScene& scene, const SensorOptions& options,
                                         std::uint64_t seed, std::uint64_t stream,
                                         const SensorFlaws& flaws = {});

}  // namespace engine
}  // namespace trivet
