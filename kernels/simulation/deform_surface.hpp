/// Smooth deviations of a surface from its model, as of printed, cast and scanned objects.
#pragma once

#include <cstdint>

#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Displace points by a sum of six plane waves with wavelengths from 0.4 to 1 diameter, in random
/// directions.
///
/// points    n positions, displaced in place [m]
/// diameter  largest extent of the surface [m], > 0
/// rms       RMS displacement over a long distance [m], >= 0
/// seed      selects the displacement field; equal points are displaced equally
void deform_surface(PointsSpan points, double diameter, double rms, std::uint64_t seed) noexcept;

}  // namespace trivet::kernels
