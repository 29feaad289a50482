/// Organized scans of surfaces given by a formula.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::test {

struct DepthScan {
  PixelGrid grid;
  Points points;
};

inline constexpr float kPixelPitch = 0.01F;  ///< spacing of a depth_scan's rays at depth 1

/// A scan by a pinhole camera at the origin that looks along z. `depth` returns z for the ray (a,
/// b, 1), or NaN for a pixel without a point.
inline DepthScan depth_scan(std::uint32_t width, std::uint32_t height,
                            const std::function<float(float a, float b)>& depth) {
  DepthScan out;
  out.grid.width = width;
  out.grid.height = height;
  const auto tangent = [](std::uint32_t pixel, std::uint32_t size) {
    return (static_cast<float>(pixel) - static_cast<float>(size) / 2) * kPixelPitch;
  };
  for (std::uint32_t v = 0; v < height; ++v) {
    for (std::uint32_t u = 0; u < width; ++u) {
      const float a = tangent(u, width), b = tangent(v, height), z = depth(a, b);
      out.grid.point_index.push_back(std::isnan(z) ? PixelGrid::kNone
                                                   : static_cast<std::int32_t>(out.points.size()));
      if (!std::isnan(z)) out.points.push_back({a * z, b * z, z});
    }
  }
  return out;
}

}  // namespace trivet::test
