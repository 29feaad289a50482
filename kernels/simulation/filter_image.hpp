/// Post-processing of depth cameras on an image of disparity or range.
///
/// Images are whole rows of values > 0; 0: no measurement. Each output pixel is computed separately
/// from the input alone: any split into chunks of rows gives the same bits. No allocation. Out must
/// not alias in.
#pragma once

#include <cstdint>
#include <span>

namespace trivet::kernels {

struct ValueImage {
  std::span<const float> values;
  std::uint32_t width = 0;  ///< > 0
  std::uint32_t height() const noexcept {
    return static_cast<std::uint32_t>(values.size() / width);
  }
};

enum class Along { rows, columns };

/// Replace each pixel by the mean of the pixels within `radius` along rows or columns that differ
/// from it by no more than `reach`. Pixels without measurement stay so.
/// Source: the two passes of the spatial filter of librealsense (post-processing filters), an
/// edge-preserving mean; its weights fall off, these do not.
void smooth_image(const ValueImage& in, std::uint32_t first_row, Along along, std::uint32_t radius,
                  float reach, std::span<float> out) noexcept;

/// Replace each pixel by the median of the measured pixels of a square of side 2 radius + 1; of an
/// even number, the lower. radius <= kMaxMedianRadius. Pixels without measurement stay so.
void median_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t radius,
                  std::span<float> out);
inline constexpr std::uint32_t kMaxMedianRadius = 3;

enum class Fill { least, most };

/// Replace each pixel without measurement by the smallest or largest of the nearest measured values
/// to its left, right, top and bottom, if there are any within `reach` pixels. Of disparities, the
/// smallest is the farthest.
/// Source: the hole-filling filter of librealsense, in its modes "farthest" and "nearest from
/// around".
void fill_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t reach, Fill fill,
                std::span<float> out) noexcept;

/// Dilate values that are greater by more than `least_jump`: a pixel gets the greatest value in the
/// square of side 2 radius + 1 about it, if that exceeds its own by so much; a pixel without
/// measurement stays so. Of disparities, the foreground grows on all sides.
/// Source: registration to another camera draws each pixel as large as it is there, and the nearest
/// wins (librealsense, align); Gschwandtner et al., BlenSor, ISVC 2011, where values spread by 3.1
/// pixels.
void grow_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t radius,
                float least_jump, std::span<float> out) noexcept;

/// Replace all pixels of each `block` x `block` square by its first one, as in an image measured at
/// low resolution and enlarged.
void coarsen_image(const ValueImage& in, std::uint32_t first_row, std::uint32_t block,
                   std::span<float> out) noexcept;

}  // namespace trivet::kernels
