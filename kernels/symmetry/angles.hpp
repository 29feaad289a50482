/// Angles that the search for symmetries turns by.
#pragma once

namespace trivet::kernels {

/// pi (3 - sqrt 5) [rad]: its multiples fall on no regular polygon.
inline constexpr float kGoldenAngle = 2.3999632F;

}  // namespace trivet::kernels
