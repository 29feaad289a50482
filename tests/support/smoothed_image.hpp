/// Depth images as a camera's filter smooths them, by a naive convolution in double.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "kernels/scans/range_image.hpp"

namespace trivet::test {

/// Smooth an image without gaps along rows, then columns: each depth is the mean of those of its line,
/// weighted by exp(-distance / length), up to the next step of more than a share of the depth. Lines
/// go on beyond the image as they end.
inline kernels::RangeImage smoothed(kernels::RangeImage image, double length,
                                    float kept_step = 0.1F) {
  const auto width = static_cast<std::ptrdiff_t>(image.geometry.width),
             height = static_cast<std::ptrdiff_t>(image.geometry.height);
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(20 * length));
  const auto along = [&](std::ptrdiff_t du, std::ptrdiff_t dv) {
    const std::vector<float> depth(image.depth.begin(), image.depth.end());
    const auto depth_at = [&](std::ptrdiff_t u, std::ptrdiff_t v) {
      const std::ptrdiff_t x = std::clamp<std::ptrdiff_t>(u, 0, width - 1),
                           y = std::clamp<std::ptrdiff_t>(v, 0, height - 1);
      return depth[static_cast<std::size_t>(y * width + x)];
    };
    for (std::ptrdiff_t v = 0; v < height; ++v) {
      for (std::ptrdiff_t u = 0; u < width; ++u) {
        double sum = static_cast<double>(depth_at(u, v)), weights = 1;
        for (const std::ptrdiff_t side : {-1, 1}) {
          float before = depth_at(u, v);
          for (std::ptrdiff_t k = 1; k <= reach; ++k) {
            const float d = depth_at(u + side * k * du, v + side * k * dv);
            if (std::abs(d - before) > kept_step * before) break;
            const double weight = std::exp(-static_cast<double>(k) / length);
            sum += weight * static_cast<double>(d);
            weights += weight;
            before = d;
          }
        }
        image.depth[static_cast<std::size_t>(v * width + u)] = static_cast<float>(sum / weights);
      }
    }
  };
  along(1, 0);
  along(0, 1);
  return image;
}

}  // namespace trivet::test
