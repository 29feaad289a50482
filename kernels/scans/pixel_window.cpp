#include "kernels/scans/pixel_window.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace trivet::kernels {
namespace {

struct Stretch {
  std::uint32_t first = 0, count = 0;
};

/// Pixel range along one axis of the image: `across` is the ball's position along it. Pre: z >
/// radius.
Stretch stretch(double focal, double middle, std::uint32_t limit, double across, double z,
                double radius) noexcept {
  const double angle = std::atan2(across, z), half = std::asin(radius / std::hypot(across, z));
  const auto pixel = [&](double tangent) {
    return std::clamp(middle + focal * tangent, -2.0, static_cast<double>(limit) + 2);
  };
  // One extra pixel on either side: rays are rounded to float.
  const double first = std::max(0.0, std::ceil(pixel(std::tan(angle - half))) - 1);
  const double last = std::min<double>(limit, std::floor(pixel(std::tan(angle + half))) + 2);
  if (!(first < last)) return {};
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)};
}

}  // namespace

PixelWindow window_of_ball(const Camera& camera, std::uint32_t width, std::uint32_t height,
                           const Eigen::Vector3d& center, double radius) noexcept {
  assert(camera.fx > 0 && camera.fy > 0 && radius >= 0 && "readers check cameras");
  if (center.z() < -radius) return {};
  if (!(center.z() > radius)) return {0, 0, width, height};
  const Stretch u = stretch(camera.fx, camera.cx, width, center.x(), center.z(), radius);
  const Stretch v = stretch(camera.fy, camera.cy, height, center.y(), center.z(), radius);
  if (u.count == 0 || v.count == 0) return {};
  return {u.first, v.first, u.count, v.count};
}

}  // namespace trivet::kernels
