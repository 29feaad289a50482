/// How a scan errs over more than a few pixels, measured where it saw planes.
#pragma once

#include <span>

#include "kernels/scans/find_planes.hpp"
#include "kernels/scans/range_image.hpp"

namespace trivet::kernels {

/// Depth from matched windows, phases or patterns errs alike in neighboring pixels: surfaces are
/// smooth, and wavy. What is left after averaging over windows of pixels, beyond what independent
/// noise leaves.
struct CorrelatedNoise {
  float height = 0;     ///< root mean square of windows' means across the surface [scene unit]
  float slope_rad = 0;  ///< mean angle that windows are tilted by
};

/// Measure patches of `kPatch` x `kPatch` windows that lie on one plane, each after the plane that
/// fits it best is taken off, and give the median patch. Zero where fewer than `kFewestPatches` lie
/// on planes.
///
/// planes  in the camera's frame, as image.plane numbers them
/// window  side of a window [pixel], >= 2
/// Source: one-way analysis of variance: the component between windows is the variance of their
/// means less the n-th part of the variance within them.
CorrelatedNoise measure_correlated_noise(const RangeImage& image, std::span<const Plane> planes,
                                         std::size_t window);

inline constexpr std::size_t kPatch = 6;
inline constexpr std::size_t kFewestPatches = 5;

}  // namespace trivet::kernels
