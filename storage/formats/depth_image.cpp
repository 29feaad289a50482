#include "storage/formats/depth_image.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace trivet::formats {
namespace {

bool usable(const Camera& camera) {
  const auto good = [](double value) { return std::isfinite(value) && value > 0; };
  return good(camera.fx) && good(camera.fy) && good(camera.depth_scale) &&
         std::isfinite(camera.cx) && std::isfinite(camera.cy);
}

}  // namespace

Result<void> check_pixels(const Input& input, std::uint64_t width, std::uint64_t height) {
  const std::uint64_t limit = std::min(input.options.max_pixels, input.max_points());
  // Divided, as the product could overflow.
  if (width > 0 && height > 0 && width <= limit && height <= limit / width) return {};
  return input.refuse(fmt::format("expected 1 to {} pixels, found {} x {}", limit, width, height));
}

Result<Camera> depth_camera(const Input& input) {
  if (!input.options.camera) {
    return input.refuse(
        "a depth image needs its camera: give fx, fy, cx, cy and depth_scale with "
        "--camera CAMERA.json or in the manifest");
  }
  if (!usable(*input.options.camera)) {
    return input.refuse(
        "expected a camera of finite numbers with fx, fy and depth_scale above zero");
  }
  return *input.options.camera;
}

Error refuse_negative(const Input& input) {
  return input.refuse(
      "expected depths above zero, found none but negative ones; the camera looks along +z: "
      "negate them");
}

}  // namespace trivet::formats
