/// Where a label fits onto what a picture shows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace trivet::engine {

inline constexpr std::uint32_t kNoLabel = std::numeric_limits<std::uint32_t>::max();

/// For each of `count` labels the index of its pixel that is farthest from pixels of others and
/// from the picture's border, in steps to the four neighbors; the first of equal ones. None for
/// labels without a pixel.
///
/// labels  row by row, each below `count` or kNoLabel; `width` divides their number
std::vector<std::optional<std::size_t>> innermost_pixels(std::span<const std::uint32_t> labels,
                                                         std::size_t width, std::size_t count);

}  // namespace trivet::engine
