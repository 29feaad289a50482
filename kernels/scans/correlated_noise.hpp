/// Spatially correlated depth noise of a scan, measured on planes.
#pragma once

#include <span>

#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// Depth errors of sensors that match windows, phases or patterns are correlated between
/// neighboring pixels: surfaces are smooth, and wavy. These values are the error that remains after
/// averaging over windows of pixels, beyond the contribution of independent noise.
struct CorrelatedNoise {
  float height = 0;     ///< RMS of the windows' means across the surface [scene unit]
  float slope_rad = 0;  ///< mean tilt angle of windows
};

/// Measure patches of `kPatch` x `kPatch` windows that lie on one plane, each relative to its
/// best-fit plane, and return the median patch. Zero if fewer than `kFewestPatches` lie on planes.
///
/// planes  planes in the camera's frame, numbered as in image.plane
/// window  side of a window [pixel], >= 2
/// Source: one-way analysis of variance. The component between windows is the variance of their
/// means minus the n-th part of the variance within them.
CorrelatedNoise measure_correlated_noise(const RangeImage& image, std::span<const Plane> planes,
                                         std::size_t window);

inline constexpr std::size_t kPatch = 6;
inline constexpr std::size_t kFewestPatches = 5;

}  // namespace trivet::kernels
