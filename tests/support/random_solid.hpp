/// Random solids as test data.
#pragma once

#include <array>

#include "kernels/simulation/solid.hpp"
#include "support/random.hpp"

namespace trivet::test {

inline Pose random_pose(Random& random, float reach) {
  Pose pose(Eigen::AngleAxisf(random.uniform(0, 6), random.direction()).toRotationMatrix());
  pose.translation() = reach * random.direction();
  return pose;
}

/// One primitive within the unit ball.
inline kernels::Solid random_primitive(Random& random) {
  using kernels::Solid;
  const float a = random.uniform(0.2F, 0.6F), b = random.uniform(0.1F, 0.3F);
  const float height = random.uniform(0.1F, 0.5F);
  const Solid ends = kernels::box({2, 2, height});
  switch (random.below(5)) {
    case 0:
      return kernels::box({a, b, height});
    case 1:
      return kernels::turned(std::array<Eigen::Vector2f, 4>{
          {{b, -height}, {a + b, -0.5F * height}, {a + b, height}, {b, height}}});
    case 2:
      return kernels::torus(a, b);
    case 3:
      return kernels::oblong(b, 0.5F * b, a) & ends;
    default:
      return kernels::half_space(random.direction(), 0.1F) & kernels::box({a, a, a});
  }
}

/// Several primitives combined by all kinds of composition.
inline kernels::Solid random_solid(Random& random, int num_parts = 4) {
  kernels::Solid out = random_primitive(random);
  for (int k = 1; k < num_parts; ++k) {
    const kernels::Solid other = moved(random_primitive(random), random_pose(random, 0.4F));
    switch (random.below(6)) {
      case 0:
        out = out - other;
        break;
      case 1:
        out = blend(out, other, 0.1F);
        break;
      case 2:
        out = out | around_z(other, 2 + random.below(4));
        break;
      case 3:
        out = mirrored_x(out) | other;
        break;
      case 4:
        out = out & (other | kernels::box({0.5F, 0.5F, 0.5F}));
        break;
      default:
        out = out | other;
    }
  }
  return out;
}

}  // namespace trivet::test
