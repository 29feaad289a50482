/// Branch-free angles, so that loops over them vectorize.
#pragma once

#include <cmath>
#include <numbers>

namespace trivet::kernels {

/// atan2 by an odd polynomial of degree 13; |error| < 1e-6 rad (minimax fit on [0, 1], test
/// `FastAngle`). atan2(0, 0) gives 0. Training and recognition both use it, so a pair lands in the
/// same bin on both sides.
inline float fast_atan2(float y, float x) noexcept {
  const float ax = std::abs(x), ay = std::abs(y);
  const float large = ax > ay ? ax : ay,
              small = ax > ay ? ay : ax;  // std::max would keep loops scalar
  const float q = small / (large > 1e-37F ? large : 1e-37F);
  const float s = q * q;
  float r = 0.00681177107617259F;
  r = r * s - 0.033604156225919724F;
  r = r * s + 0.07962360978126526F;
  r = r * s - 0.1323333978652954F;
  r = r * s + 0.19807815551757812F;
  r = r * s - 0.3331736922264099F;
  r = (r * s + 0.9999961256980896F) * q;
  r = ay > ax ? 0.5F * std::numbers::pi_v<float> - r : r;
  r = x < 0 ? std::numbers::pi_v<float> - r : r;
  return y < 0 ? -r : r;
}

}  // namespace trivet::kernels
