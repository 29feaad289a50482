/// Image window of an object.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "storage/data/cloud.hpp"

namespace trivet::kernels {

/// A rectangle of pixels of an image.
struct PixelWindow {
  std::uint32_t left = 0, top = 0, width = 0, height = 0;

  std::size_t size() const noexcept { return std::size_t{width} * height; }
  bool empty() const noexcept { return size() == 0; }
  bool contains(std::uint32_t u, std::uint32_t v) const noexcept {
    return u >= left && u - left < width && v >= top && v - top < height;
  }
  bool overlaps(const PixelWindow& other) const noexcept {
    return !empty() && !other.empty() && left < other.left + other.width &&
           other.left < left + width && top < other.top + other.height && other.top < top + height;
  }
  bool operator==(const PixelWindow&) const = default;
};

/// Find the smallest window, up to one pixel, of all pixels whose rays can touch a ball.
///
/// camera         pinhole with fx, fy > 0
/// width, height  size of the image [pixel]
/// center         center of the ball in the camera's frame, radius >= 0 in the same unit
/// A ball behind the camera gives an empty window, one that reaches the plane z = 0 the whole
/// image. In the plane of the optical axis and the image's x, the ball is a disc seen at angle a
/// that covers a +- asin(radius / distance): its tangents bound every pixel's u. The same holds for
/// v.
PixelWindow window_of_ball(const Camera& camera, std::uint32_t width, std::uint32_t height,
                           const Eigen::Vector3d& center, double radius) noexcept;

/// The camera whose whole image is the window.
inline Camera camera_of_window(Camera camera, const PixelWindow& window) noexcept {
  camera.cx -= window.left;
  camera.cy -= window.top;
  return camera;
}

}  // namespace trivet::kernels
