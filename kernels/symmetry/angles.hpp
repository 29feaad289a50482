/// Angles that the search for symmetries turns by.
#pragma once

#include <numbers>

namespace trivet::kernels {

inline constexpr float kPi = std::numbers::pi_v<float>;
/// pi (3 - sqrt 5) [rad]: its multiples fall on no regular polygon.
inline constexpr float kGoldenAngle = 2.3999632F;

}  // namespace trivet::kernels
