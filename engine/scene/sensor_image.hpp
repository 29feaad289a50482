/// Depth images of points, which belong to the pixels of a sensor or of a virtual camera.
#pragma once

#include <cstddef>
#include <cstdint>

#include "kernels/scans/range_image.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

inline constexpr std::size_t kRowGrain = 8;          ///< image rows per task
inline constexpr std::size_t kPixelGrain = 1 << 16;  ///< pixels per task with little work per pixel

/// Half-width of the window for measuring the scene's noise, in pixels or spacings.
inline constexpr std::uint32_t kNoiseWindow = 2;

/// Half-width of the window for normals. It is wide enough that the noise turns them by about the
/// quantization of the pair's angles, and no wider, since corners become rounded.
float choose_window(float noise, float spacing) noexcept;

/// Pixel geometry of the sensor: given, recovered from the grid, or constructed for scattered
/// points.
struct SensorView {
  kernels::ImageGeometry geometry;
  PixelGrid grid;
  bool scattered = false;  ///< whether points lie beside the rays through their pixels' centers
};

/// Depth and normal of each pixel from the points in the grid.
kernels::RangeImage make_image(const SensorView& view, const OrientedView& cloud);

/// Fill single missing pixels, which scattered points leave between them, with their neighbors'
/// normals.
void close_holes(float max_step, kernels::RangeImage& image);

}  // namespace trivet::engine
