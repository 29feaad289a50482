#include "engine/pictures/innermost_pixels.hpp"

#include <algorithm>

namespace trivet::engine {

std::vector<std::optional<std::size_t>> innermost_pixels(std::span<const std::uint32_t> labels,
                                                         std::size_t width, std::size_t count) {
  // Distance transform of Rosenfeld and Pfaltz, J. ACM 1966: one pass down, one up.
  const std::size_t size = labels.size();
  std::vector<std::uint32_t> depth(size, 1);
  const auto beyond = [&](std::size_t pixel, bool is_inside, std::size_t other) -> std::uint32_t {
    return is_inside && labels[other] == labels[pixel] ? depth[other] : 0;
  };
  for (std::size_t i = 0; i < size; ++i) {
    depth[i] = 1 + std::min(beyond(i, i % width > 0, i - 1), beyond(i, i >= width, i - width));
  }
  for (std::size_t i = size; i-- > 0;) {
    depth[i] = std::min(depth[i], 1 + std::min(beyond(i, (i + 1) % width > 0, i + 1),
                                               beyond(i, i + width < size, i + width)));
  }
  std::vector<std::optional<std::size_t>> out(count);
  for (std::size_t i = 0; i < size; ++i) {
    if (labels[i] == kNoLabel) continue;
    std::optional<std::size_t>& best = out[labels[i]];
    if (!best || depth[i] > depth[*best]) best = i;
  }
  return out;
}

}  // namespace trivet::engine
