/// Placement of labels in a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace trivet::engine {

inline constexpr std::uint32_t kNoLabel = std::numeric_limits<std::uint32_t>::max();

/// For each of `count` labels, the index of its pixel that is farthest from pixels of other labels
/// and from the picture's border, in steps to the four neighbors; for ties the first. Absent for
/// labels without a pixel.
///
/// labels  row by row, each below `count` or kNoLabel; `width` divides their number
std::vector<std::optional<std::size_t>> innermost_pixels(std::span<const std::uint32_t> labels,
                                                         std::size_t width, std::size_t count);

}  // namespace trivet::engine
