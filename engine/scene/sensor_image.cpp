#include "engine/scene/sensor_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/common/parallel.hpp"
#include "storage/common/stop.hpp"

namespace trivet::engine {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

/// Depth at a pixel's center of the plane through one of its points. Where the plane is so oblique
/// that it leaves the pixel far from the point, the point's own depth.
float depth_at_center(const kernels::ImageGeometry& geometry, std::size_t pixel,
                      const Eigen::Vector3f& point, const Eigen::Vector3f& normal) {
  const Eigen::Vector3f ray = geometry.back_project(pixel, 1);
  const float depth = normal.dot(point) / normal.dot(ray);
  const bool is_near = std::abs(depth - point.z()) < 4 * point.z() / geometry.fx;
  return is_near ? depth : point.z();  // also where there is no normal
}

}  // namespace

float choose_window(float noise, float spacing) noexcept {
  return std::clamp(2 + 3.5F * noise / spacing, 2.0F, 7.0F);
}

kernels::RangeImage make_image(const SensorView& view, const OrientedView& cloud) {
  const kernels::ImageGeometry& geometry = view.geometry;
  kernels::RangeImage image;
  image.geometry = geometry;
  const std::size_t n = view.grid.point_index.size();
  image.depth.assign(n, 0);
  image.plane.assign(n, 0);
  image.near_plane.assign(n, 0);
  image.normals.resize(n);
  const Eigen::Matrix3f R = geometry.T_camera_scene.linear();
  for_chunks(n, kPixelGrain, [&](std::size_t first, std::size_t count) {
    for (std::size_t pixel = first; pixel < first + count; ++pixel) {
      const std::int32_t i = view.grid.point_index[pixel];
      if (i == PixelGrid::kNone) {
        image.normals.set(pixel, Eigen::Vector3f::Constant(kUnknown));
        continue;
      }
      const auto at = static_cast<std::size_t>(i);
      const Eigen::Vector3f p = geometry.T_camera_scene * cloud.points[at];
      const Eigen::Vector3f normal = R * cloud.normals[at];
      image.depth[pixel] = view.scattered ? depth_at_center(geometry, pixel, p, normal) : p.z();
      image.normals.set(pixel, normal);
    }
  });
  return image;
}

void close_holes(float max_step, kernels::RangeImage& image) {
  const Column<float> measured = image.depth;
  kernels::fill_small_holes(image.geometry, max_step, 4, image.depth);
  const std::size_t width = image.geometry.width;
  StopCheck check_stop(kPixelGrain);
  for (std::size_t pixel = width + 1; pixel + width + 1 < measured.size(); ++pixel) {
    check_stop();
    if (measured[pixel] > 0 || !(image.depth[pixel] > 0)) continue;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (const std::size_t row : {pixel - width, pixel, pixel + width}) {
      for (const std::size_t at : {row - 1, row, row + 1}) {
        if (std::isfinite(image.normals.view().x[at])) sum += image.normals[at];
      }
    }
    if (sum.norm() > 0) image.normals.set(pixel, sum.normalized());
  }
}

}  // namespace trivet::engine
