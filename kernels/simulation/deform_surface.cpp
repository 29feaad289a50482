#include "kernels/simulation/deform_surface.hpp"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <numbers>

#include "kernels/common/counter_random.hpp"

namespace trivet::kernels {

void deform_surface(PointsSpan points, double diameter, double rms, std::uint64_t seed) noexcept {
  struct Wave {
    Eigen::Vector3d towards, shift;  // wave vector [rad / m], displacement [m]
    double phase;
  };
  std::array<Wave, 6> waves;
  // A wave's mean square is half its squared amplitude, and the waves are independent.
  const double height = rms * std::sqrt(2.0 / static_cast<double>(waves.size()));
  for (std::size_t k = 0; k < waves.size(); ++k) {
    CounterRandom random(seed, 0, k);
    const auto direction = [&] {
      Eigen::Vector3d v(random.normal(), random.normal(), random.normal());
      return Eigen::Vector3d(v.normalized());
    };
    constexpr double kTurn = 2 * std::numbers::pi;
    waves[k].towards = direction() * (kTurn / (diameter * random.uniform(0.4, 1)));
    waves[k].shift = direction() * height;
    waves[k].phase = random.uniform(0, kTurn);
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p(static_cast<double>(points.x[i]), static_cast<double>(points.y[i]),
                            static_cast<double>(points.z[i]));
    Eigen::Vector3d moved = p;
    for (const Wave& wave : waves) moved += wave.shift * std::sin(wave.towards.dot(p) + wave.phase);
    points.x[i] = static_cast<float>(moved.x());
    points.y[i] = static_cast<float>(moved.y());
    points.z[i] = static_cast<float>(moved.z());
  }
}

}  // namespace trivet::kernels
