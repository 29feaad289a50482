/// Common code of all depth image formats.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/common/stop.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/undistort.hpp"

namespace trivet::formats {

inline constexpr std::size_t kStopCheckPixels = 1 << 18;  ///< pixels between two checks

/// Checks that there are pixels, and no more than allowed. Errors: bad_data.
Result<void> check_pixels(const Input& input, std::uint64_t width, std::uint64_t height);

/// The camera from the options. Errors: bad_data (no camera, an impossible one, or one for an image
/// size other than width x height).
Result<Camera> depth_camera(const Input& input, std::uint64_t width, std::uint64_t height);

/// Error for an image without any measurement in front of the camera.
Error refuse_negative(const Input& input);

/// Back-project each measured pixel of a camera without distortion.
///
/// depth_at   (pixel) -> raw depth, row-major; not finite, zero and below are no measurement
/// Errors: bad_data if all depths are negative, as along the -z axis of OpenGL.
/// Pre: the size passed check_pixels.
template <class DepthAt>
Result<Cloud> back_project_pinhole(const Input& input, std::uint32_t width, std::uint32_t height,
                                   const Camera& camera, DepthAt&& depth_at) {
  const std::size_t num_pixels = std::size_t{width} * height;
  std::size_t num_measured = 0, num_negative = 0;
  const auto is_measured = [](double raw) { return raw > 0 && std::isfinite(raw); };
  StopCheck check_stop(kStopCheckPixels);
  for (std::size_t pixel = 0; pixel < num_pixels; ++pixel) {
    check_stop();
    const double raw = depth_at(pixel);
    num_measured += is_measured(raw);
    num_negative += raw < 0;
  }
  if (num_measured == 0 && num_negative > 0) return refuse_negative(input);

  Cloud cloud;
  cloud.points.reserve(num_measured);
  cloud.grid = PixelGrid{width, height, Column<std::int32_t>(num_pixels, PixelGrid::kNone)};
  for (std::size_t pixel = 0; pixel < num_pixels; ++pixel) {
    check_stop();
    const double raw = depth_at(pixel);
    if (!is_measured(raw)) continue;
    const std::size_t u = pixel % width, v = pixel / width;
    const double right = static_cast<double>(u) - camera.cx,
                 down = static_cast<double>(v) - camera.cy;
    double z = raw * camera.depth_scale;
    if (camera.depth == DepthKind::ray) z /= std::hypot(1.0, right / camera.fx, down / camera.fy);
    const double x = right * z / camera.fx;
    const double y = down * z / camera.fy;
    cloud.grid->point_index[pixel] = static_cast<std::int32_t>(cloud.points.size());
    cloud.points.push_back({to_float(x), to_float(y), to_float(z)});
  }
  cloud.camera = camera;
  cloud.viewpoint = Eigen::Vector3f::Zero();
  return cloud;
}

/// As above, for any camera; distortion is undone first.
template <class DepthAt>
Result<Cloud> back_project(const Input& input, std::uint32_t width, std::uint32_t height,
                           const Camera& camera, DepthAt&& depth_at) {
  if (camera.distortion.none()) return back_project_pinhole(input, width, height, camera, depth_at);
  std::vector<float> raw(std::size_t{width} * height);
  for (std::size_t pixel = 0; pixel < raw.size(); ++pixel)
    raw[pixel] = to_float(static_cast<double>(depth_at(pixel)));
  const std::vector<float> pinhole = undistort(raw, width, height, camera);
  return back_project_pinhole(input, width, height, camera,
                              [&](std::size_t pixel) -> double { return pinhole[pixel]; });
}

}  // namespace trivet::formats
