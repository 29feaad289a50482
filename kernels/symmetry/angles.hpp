/// Rotation angles of the symmetry search.
#pragma once

namespace trivet::kernels {

/// pi (3 - sqrt 5) [rad]: its multiples do not coincide with any regular polygon.
inline constexpr float kGoldenAngle = 2.3999632F;

}  // namespace trivet::kernels
