#include "kernels/scans/ground_planes.hpp"

#include <utility>

#include "kernels/scans/connected_pixels.hpp"

namespace trivet::kernels {
namespace {

constexpr float kApart = 2;  // thicknesses: both surfaces scatter by one

/// Whether a patch of at least `size` connected pixels has a mark; removes the marks.
bool has_patch(std::size_t width, std::size_t size, std::vector<std::uint8_t>& marks) {
  ConnectedPixels connected(width, marks.size());
  for (std::size_t first = 0; first < marks.size(); ++first) {
    std::size_t count = 0;
    connected.grow(
        first, [&](std::size_t pixel) { return std::exchange(marks[pixel], 0) != 0; },
        [&](std::size_t) { ++count; });
    if (count >= size) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> find_ground(const RangeImage& image, std::span<const Plane> planes,
                                      std::size_t opening) {
  const ImageGeometry& geometry = image.geometry;
  std::vector<std::uint8_t> ground, behind(image.depth.size());
  for (const Plane& plane : planes) {
    for (std::size_t pixel = 0; pixel < behind.size(); ++pixel) {
      const float depth = image.depth[pixel];
      behind[pixel] = depth > 0 && plane.normal.dot(geometry.back_project(pixel, depth)) <
                                       plane.offset - kApart * plane.thickness;
    }
    ground.push_back(has_patch(geometry.width, opening, behind) ? 0 : 1);
  }
  return ground;
}

}  // namespace trivet::kernels
