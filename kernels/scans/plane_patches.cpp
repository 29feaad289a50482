#include "kernels/scans/plane_patches.hpp"

#include <algorithm>
#include <cmath>

#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

constexpr float kGrazing = 0.05F;  // of incidence: planes through the camera have no area

/// Area of the plane that a pixel sees.
float pixel_area(const ImageGeometry& geometry, const Plane& plane, std::size_t pixel,
                 float depth) {
  const float facing =
      std::max(kGrazing, std::abs(plane.normal.dot(geometry.back_project(pixel, 1))));
  return depth * depth / (geometry.fx * geometry.fy * facing);
}

}  // namespace

std::vector<float> largest_patches(const RangeImage& image, std::span<const Plane> planes) {
  const ImageGeometry& geometry = image.geometry;
  const std::size_t width = geometry.width, n = image.near_plane.size();
  std::vector<float> largest(planes.size(), 0);
  std::vector<std::uint8_t> visited(n, 0);
  std::vector<std::uint32_t> open;
  StopCheck check_stop(1 << 16);
  for (std::size_t first = 0; first < n; ++first) {
    const std::uint8_t label = image.near_plane[first];
    if (label == 0 || visited[first] != 0) continue;
    const Plane& plane = planes[label - 1U];
    const auto visit = [&](std::size_t pixel) {
      if (image.near_plane[pixel] != label || visited[pixel] != 0) return;
      visited[pixel] = 1;
      open.push_back(static_cast<std::uint32_t>(pixel));
    };
    double area = 0;
    visit(first);
    while (!open.empty()) {
      check_stop();
      const std::size_t pixel = open.back(), column = pixel % width;
      open.pop_back();
      area += static_cast<double>(pixel_area(geometry, plane, pixel, image.depth[pixel]));
      if (column > 0) visit(pixel - 1);
      if (column + 1 < width) visit(pixel + 1);
      if (pixel >= width) visit(pixel - width);
      if (pixel + width < n) visit(pixel + width);
    }
    largest[label - 1U] = std::max(largest[label - 1U], static_cast<float>(area));
  }
  return largest;
}

}  // namespace trivet::kernels
