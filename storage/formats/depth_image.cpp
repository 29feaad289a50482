#include "storage/formats/depth_image.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace trivet::formats {
namespace {

bool usable(const Camera& camera) {
  const auto good = [](double value) { return std::isfinite(value) && value > 0; };
  const auto& [k1, k2, p1, p2, k3, k4, k5, k6] = camera.distortion;
  return good(camera.fx) && good(camera.fy) && good(camera.depth_scale) &&
         std::isfinite(camera.cx) && std::isfinite(camera.cy) &&
         std::isfinite(k1 + k2 + p1 + p2 + k3 + k4 + k5 + k6);
}

}  // namespace

Result<void> check_pixels(const Input& input, std::uint64_t width, std::uint64_t height) {
  const std::uint64_t limit = std::min(input.options.max_pixels, input.max_points());
  // Division, as the product could overflow.
  if (width > 0 && height > 0 && width <= limit && height <= limit / width) return {};
  return input.refuse(fmt::format("expected 1 to {} pixels, found {} x {}", limit, width, height));
}

Result<Camera> depth_camera(const Input& input, std::uint64_t width, std::uint64_t height) {
  if (!input.options.camera) {
    return input.refuse(
        "a depth image needs its camera: give fx, fy, cx, cy and depth_scale with "
        "--camera CAMERA.json or in the manifest");
  }
  if (!usable(*input.options.camera)) {
    return input.refuse(
        "expected a camera of finite numbers with fx, fy and depth_scale above zero");
  }
  const Camera& camera = *input.options.camera;
  if ((camera.width > 0 && camera.width != width) ||
      (camera.height > 0 && camera.height != height)) {
    const auto size_text = [](std::uint32_t size) {
      return size > 0 ? std::to_string(size) : "any";
    };
    return input.refuse(
        fmt::format("expected an image of {} x {} pixels, as its camera's, found {} x {}; give the "
                    "camera of this size",
                    size_text(camera.width), size_text(camera.height), width, height));
  }
  return camera;
}

Error refuse_negative(const Input& input) {
  return input.refuse(
      "expected depths above zero, found none but negative ones; the camera looks along +z: "
      "negate them");
}

}  // namespace trivet::formats
