/// Received light of a time-of-flight camera with its light at the lens.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/simulation/measure_scene.hpp"
#include "kernels/common/counter_random.hpp"

namespace trivet::engine {

/// Received light, and range [m] times light.
struct Echo {
  double light = 0, moment = 0;
  void add(double range, double signal) {
    light += signal;
    moment += signal * range;
  }
};

/// Computes the received light of pixels. All parameters must outlive it.
class Echoes {
 public:
  explicit Echoes(const ExactScene& scene)
      : rays_(scene.rays), camera_(scene.camera), image_(scene.image), finishes_(scene.finishes) {}

  /// Direction of a pixel's ray, with length 1 along the optical axis.
  Eigen::Vector3d ray(double u, double v) const {
    return {(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1};
  }
  Eigen::Vector3d ray(std::size_t i) const {
    return ray(static_cast<double>(i % image_.width), static_cast<double>(i / image_.width));
  }

  /// Direct light from the surface that a pixel sees; at a depth edge, from all over the pixel.
  ///
  /// i      a pixel that sees a surface
  /// glint  receives the factor of the noise due to mirrored light; infinite: no measurement
  Echo direct(std::size_t i, double& glint) const;

  /// Light reflected by one other surface, relative to a direct light of 1. `light` is the share,
  /// `moment` is the share times the path beyond the direct range [m]. Both surfaces are diffuse,
  /// and the other one is lit where the camera sees it. The result is the mean over random
  /// directions, which are denser near the surface normal.
  Echo bounced(std::size_t i, int num_rays, kernels::CounterRandom& random) const;

 private:
  Echo subpixel_echo(std::size_t i) const;

  const kernels::RayScene& rays_;
  const Camera& camera_;
  const ExactImage& image_;
  std::span<const Finish> finishes_;
};

/// Measured range of an echo [m]; 0: too little light.
///
/// noise  standard deviation relative to the noise law
double range_of(const Echo& echo, double noise, kernels::CounterRandom& random);

/// Measure with flaws (SensorFlaws::echo and patches).
///
/// Parameters are those of measure_scene. Returns depths [m]; 0 for no measurement. Same bits for
/// any number of threads.
std::vector<float> echo_scene(const ExactScene& scene, const SensorOptions& options,
                              const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
