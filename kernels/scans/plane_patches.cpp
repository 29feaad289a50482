#include "kernels/scans/plane_patches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "kernels/scans/connected_pixels.hpp"

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
  ConnectedPixels connected(width, n);
  for (std::size_t first = 0; first < n; ++first) {
    const std::uint8_t label = image.near_plane[first];
    if (label == 0 || visited[first] != 0) continue;
    const Plane& plane = planes[label - 1U];
    double area = 0;
    connected.grow(
        first,
        [&](std::size_t pixel) {
          return image.near_plane[pixel] == label && std::exchange(visited[pixel], 1) == 0;
        },
        [&](std::size_t pixel) {
          area += static_cast<double>(pixel_area(geometry, plane, pixel, image.depth[pixel]));
        });
    largest[label - 1U] = std::max(largest[label - 1U], static_cast<float>(area));
  }
  return largest;
}

}  // namespace trivet::kernels
