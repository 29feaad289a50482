/// Depth images as a pinhole would have taken them.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "storage/data/cloud.hpp"

namespace trivet::formats {

/// Where the lens shows what a pinhole shows at a place of its image.
///
/// x, y   x / z and y / z
/// Returns both as the lens bends them; none beyond where the model turns back, as no lens does.
/// Source: D. C. Brown, Photogrammetric Engineering 32, 1966, as OpenCV writes it.
std::optional<std::pair<double, double>> distort(const LensDistortion& lens, double x,
                                                 double y) noexcept;

/// Take each pixel of the pinhole's image from where the lens shows it: from the four around by
/// inverse depth, which is exact on planes, where these lie on one surface; else the nearest, so that
/// nothing is put across an edge.
///
/// raw   width * height depths, row-major; zero and below are no measurement
/// Returns as many; 0 where the image does not reach, or nothing was measured.
std::vector<float> undistort(std::span<const float> raw, std::uint32_t width, std::uint32_t height,
                             const Camera& camera);

}  // namespace trivet::formats
