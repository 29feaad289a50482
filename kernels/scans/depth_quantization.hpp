/// The steps in which a scan's depths are measured or stored.
#pragma once

#include <cmath>
#include <span>

namespace trivet::kernels {

/// The step between the depths of a scan near their median, in their unit: the median distance of
/// neighboring ones that differ, within a tenth of it. 0 if they are not in steps: depths are rarely
/// equal, or fewer than ten steps are seen.
///
/// depths  > 0, in any order; reordered
/// A depth image in whole millimeters has steps of 1 mm; those of sensors that match images in
/// fractions of a pixel grow with the square of range. Cost: O(n log n).
float quantization_step(std::span<float> depths);

/// The standard deviation of an error that is uniform within a step, in its unit.
inline float quantization_error(float step) noexcept { return step / std::sqrt(12.0F); }

}  // namespace trivet::kernels
