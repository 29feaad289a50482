/// What a time-of-flight camera, with its light at the lens, gets back from a scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/simulation/measure_scene.hpp"
#include "kernels/common/counter_random.hpp"

namespace trivet::engine {

/// Light, and range [m] times light.
struct Echo {
  double light = 0, moment = 0;
  void add(double range, double signal) {
    light += signal;
    moment += signal * range;
  }
};

/// The light of each pixel. All parameters outlive it.
class Echoes {
 public:
  explicit Echoes(const ExactScene& scene)
      : rays_(scene.rays), camera_(scene.camera), image_(scene.image), finishes_(scene.finishes) {}

  /// Along a pixel's ray; of length 1 along the optical axis.
  Eigen::Vector3d ray(double u, double v) const {
    return {(u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy, 1};
  }
  Eigen::Vector3d ray(std::size_t i) const {
    return ray(static_cast<double>(i % image_.width), static_cast<double>(i / image_.width));
  }

  /// Light straight from what a pixel sees: at a depth edge from all over the pixel.
  ///
  /// i      a pixel that sees something
  /// glint  becomes how much stronger the noise is by mirrored light; infinite: no measurement
  Echo direct(std::size_t i, double& glint) const;

  /// Light that comes back over one other surface, for a direct light of 1: `light` is the share,
  /// `moment` that times the way beyond the direct range [m]. Both surfaces are diffuse, and the
  /// other is lit where the camera sees it. Mean over so many random directions, likelier where the
  /// surface faces.
  Echo bounced(std::size_t i, int num_rays, kernels::CounterRandom& random) const;

 private:
  Echo all_over(std::size_t i) const;

  const kernels::RayScene& rays_;
  const Camera& camera_;
  const ExactImage& image_;
  std::span<const Finish> finishes_;
};

/// Range [m] that an echo tells; 0: too little light.
///
/// noise  standard deviation in that of the law
double range_of(const Echo& echo, double noise, kernels::CounterRandom& random);

/// Measure with flaws (SensorFlaws::echo and patches).
///
/// Parameters as of measure_scene. Returns depths [m]; 0 for no measurement. Same bits for any
/// number of threads.
std::vector<float> echo_scene(const ExactScene& scene, const SensorOptions& options,
                              const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
