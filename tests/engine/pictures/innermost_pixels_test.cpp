#include "engine/pictures/innermost_pixels.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "support/random.hpp"

namespace trivet::engine {
namespace {

/// Steps from a pixel to the nearest pixel with another label or beyond the border.
std::size_t depth_of(std::span<const std::uint32_t> labels, std::size_t width, std::size_t pixel) {
  const auto w = static_cast<std::ptrdiff_t>(width),
             h = static_cast<std::ptrdiff_t>(labels.size() / width),
             u = static_cast<std::ptrdiff_t>(pixel) % w, v = static_cast<std::ptrdiff_t>(pixel) / w;
  std::ptrdiff_t least = w + h;
  for (std::ptrdiff_t y = -1; y <= h; ++y) {
    for (std::ptrdiff_t x = -1; x <= w; ++x) {
      const bool inside = x >= 0 && y >= 0 && x < w && y < h;
      if (inside && labels[static_cast<std::size_t>(y * w + x)] == labels[pixel]) continue;
      least = std::min(least, std::abs(x - u) + std::abs(y - v));
    }
  }
  return static_cast<std::size_t>(least);
}

TEST(InnermostPixels, AreAsDeepAsAnyOfTheirLabel) {
  test::Random random(5);
  for (const std::size_t width : {1U, 2U, 7U, 16U}) {
    std::vector<std::uint32_t> labels(width * 9);
    for (std::uint32_t& label : labels) label = random.below(4) == 0 ? kNoLabel : random.below(2);
    const auto found = innermost_pixels(labels, width, 3);
    EXPECT_FALSE(found[2]) << "no pixel has it";
    for (std::uint32_t label = 0; label < 2; ++label) {
      std::size_t deepest = 0;
      for (std::size_t i = 0; i < labels.size(); ++i) {
        if (labels[i] == label) deepest = std::max(deepest, depth_of(labels, width, i));
      }
      ASSERT_EQ(found[label].has_value(), deepest > 0);
      if (!found[label]) continue;
      EXPECT_EQ(labels[*found[label]], label);
      EXPECT_EQ(depth_of(labels, width, *found[label]), deepest);
    }
  }
}

TEST(InnermostPixels, AreTheMiddleOfABlock) {
  std::vector<std::uint32_t> labels(10 * 8, kNoLabel);
  for (std::size_t v = 2; v < 7; ++v) {
    for (std::size_t u = 3; u < 8; ++u) labels[10 * v + u] = 0;
  }
  EXPECT_EQ(innermost_pixels(labels, 10, 1)[0], 10U * 4 + 5);
}

}  // namespace
}  // namespace trivet::engine
