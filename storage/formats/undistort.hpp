/// Undistortion of depth images.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "storage/data/cloud.hpp"

namespace trivet::formats {

/// Position in the distorted image for a position in the pinhole's image.
///
/// x, y   x / z and y / z
/// Returns both after distortion; empty beyond the radius where the model folds back, which no lens
/// does.
/// Source: D. C. Brown, Photogrammetric Engineering 32, 1966, in OpenCV's form.
std::optional<std::pair<double, double>> distort(const LensDistortion& lens, double x,
                                                 double y) noexcept;

/// Resample each pixel of the pinhole's image from its distorted position. If the four surrounding
/// pixels lie on one surface, inverse depth is interpolated, which is exact on planes; otherwise
/// the nearest pixel is used, so that nothing is interpolated across an edge.
///
/// raw   width * height depths, row-major; zero and below are no measurement
/// Returns as many; 0 outside the image or without a measurement.
std::vector<float> undistort(std::span<const float> raw, std::uint32_t width, std::uint32_t height,
                             const Camera& camera);

}  // namespace trivet::formats
