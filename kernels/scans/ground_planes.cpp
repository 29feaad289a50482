#include "kernels/scans/ground_planes.hpp"

#include "storage/common/stop.hpp"

namespace trivet::kernels {
namespace {

constexpr float kApart = 2;  // thicknesses: both surfaces scatter by one

/// Whether a patch of at least `size` connected pixels has a mark; removes the marks.
bool has_patch(std::size_t width, std::size_t size, std::vector<std::uint8_t>& marks) {
  std::vector<std::uint32_t> open;
  StopCheck check_stop(1 << 16);
  const std::size_t n = marks.size();
  for (std::size_t first = 0; first < n; ++first) {
    const auto visit = [&](std::size_t pixel) {
      if (marks[pixel] == 0) return;
      marks[pixel] = 0;
      open.push_back(static_cast<std::uint32_t>(pixel));
    };
    std::size_t count = 0;
    visit(first);
    while (!open.empty()) {
      check_stop();
      const std::size_t pixel = open.back(), column = pixel % width;
      open.pop_back();
      if (++count == size) return true;
      if (column > 0) visit(pixel - 1);
      if (column + 1 < width) visit(pixel + 1);
      if (pixel >= width) visit(pixel - width);
      if (pixel + width < n) visit(pixel + width);
    }
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
