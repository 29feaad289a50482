/// Let a surface deviate smoothly from its model, as printed, cast and scanned objects do.
#pragma once

#include <cstdint>

#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Displace points by a sum of six plane waves of lengths from 0.4 to 1 diameter, in random
/// directions.
///
/// points    n positions, displaced in place [m]
/// diameter  largest extent of the surface [m], > 0
/// rms       root of the mean squared displacement over a long way [m], >= 0
/// seed      another one gives another field; equal points are displaced equally
void deform_surface(PointsSpan points, double diameter, double rms, std::uint64_t seed) noexcept;

}  // namespace trivet::kernels
