#include "kernels/verification/expected_depths.hpp"

#include <algorithm>
#include <cmath>

#include "storage/common/clamped_integer.hpp"

namespace trivet::kernels {
namespace {

constexpr float kMarginLengths = 3;  // lengths of the filter: a twentieth of its weight lies beyond
constexpr float kKeptStep = 0.1F;    // of the depth
constexpr int kMostMargin = 64;      // rays
constexpr float kLeastLength = 0.1F;  // distances of rays: a shorter filter smooths nothing

/// A line of depths: every `stride`-th of an array.
struct DepthLine {
  float* first;
  std::ptrdiff_t stride;
  int count;
};

/// Smooth a line in one direction; each depth keeps this share of the depth before it.
void smooth_along(const DepthLine& line, float share) noexcept {
  float before = 0;
  for (int k = 0; k < line.count; ++k) {
    float& depth = line.first[k * line.stride];
    const bool is_joined = depth > 0 && before > 0 && std::abs(depth - before) < kKeptStep * depth;
    if (is_joined) depth += share * (before - depth);
    before = depth;
  }
}

void smooth_both_ways(const DepthLine& line, float share) noexcept {
  smooth_along(line, share);
  smooth_along({line.first + (line.count - 1) * line.stride, -line.stride, line.count}, share);
}

}  // namespace

void expect_depths(const RangeImage& image, const RayCrop& crop, const RayHits& hits,
                   float smoothing, Column<float>& scene, Column<float>& expected) {
  expected.assign(hits.depths.begin(), hits.depths.end());
  const float length = smoothing / static_cast<float>(crop.stride);
  if (!(length > kLeastLength)) return;
  const int margin = clamped_integer(std::ceil(kMarginLengths * length), 1, kMostMargin);
  const int width = crop.width + 2 * margin, height = crop.height + 2 * margin;
  const auto at = [&](int i, int j) {
    return static_cast<std::size_t>(j + margin) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(i + margin);
  };
  scene.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  const int columns = static_cast<int>(image.geometry.width),
            rows = static_cast<int>(image.geometry.height);
  for (int j = -margin; j < crop.height + margin; ++j) {
    const int v = crop.v(j);
    if (v < 0 || v >= rows) continue;
    for (int i = -margin; i < crop.width + margin; ++i) {
      const int u = crop.u(i);
      if (u < 0 || u >= columns) continue;
      scene[at(i, j)] = image.depth[static_cast<std::size_t>(v) * image.geometry.width +
                                    static_cast<std::size_t>(u)];
    }
  }
  for (int j = 0; j < crop.height; ++j) {
    for (int i = 0; i < crop.width; ++i) {
      const float depth = hits.depths[crop.at(i, j)];
      if (std::isfinite(depth)) scene[at(i, j)] = depth;
    }
  }
  const float share = std::exp(-1 / length);
  for (int j = 0; j < height; ++j)
    smooth_both_ways(
        {&scene[static_cast<std::size_t>(j) * static_cast<std::size_t>(width)], 1, width}, share);
  for (int i = 0; i < width; ++i)
    smooth_both_ways({&scene[static_cast<std::size_t>(i)], width, height}, share);
  for (int j = 0; j < crop.height; ++j) {
    for (int i = 0; i < crop.width; ++i) {
      float& depth = expected[crop.at(i, j)];
      if (std::isfinite(depth)) depth = scene[at(i, j)];
    }
  }
}

}  // namespace trivet::kernels
