/// A scan as a depth image with normals, for verification and refinement.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>

#include "storage/common/columns.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// The longest focal length [pixel]: floats do not resolve finer directions.
inline constexpr double kLargestFocalLength = 1e7;

/// Pinhole geometry of an image. Camera axes as in OpenCV: x right, y down, z forward.
struct ImageGeometry {
  Pose T_camera_scene = Pose::Identity();
  float fx = 0, fy = 0, cx = 0, cy = 0;  ///< [pixel]
  std::uint32_t width = 0, height = 0;

  /// Index of the pixel that a point of the camera frame projects to, or -1 outside or behind.
  std::int64_t pixel_of(const Eigen::Vector3f& p) const noexcept {
    if (!(p.z() > 0)) return -1;
    const float u = fx * p.x() / p.z() + cx + 0.5F, v = fy * p.y() / p.z() + cy + 0.5F;
    if (!(u >= 0 && v >= 0 && u < static_cast<float>(width) && v < static_cast<float>(height)))
      return -1;
    return static_cast<std::int64_t>(v) * width + static_cast<std::int64_t>(u);
  }
  /// The camera-frame point at depth z that projects to the center of a pixel.
  Eigen::Vector3f back_project(std::size_t pixel, float z) const noexcept {
    const std::size_t row = pixel / width, column = pixel % width;
    const auto u = static_cast<float>(column), v = static_cast<float>(row);
    return {(u - cx) * z / fx, (v - cy) * z / fy, z};
  }
};

/// The geometry of a camera in its own frame.
inline ImageGeometry geometry_of(const Camera& camera, const PixelGrid& grid) {
  return {.fx = static_cast<float>(camera.fx),
          .fy = static_cast<float>(camera.fy),
          .cx = static_cast<float>(camera.cx),
          .cy = static_cast<float>(camera.cy),
          .width = grid.width,
          .height = grid.height};
}

/// Depth and normals per pixel; all columns have width * height values.
struct RangeImage {
  ImageGeometry geometry;
  Column<float> depth;  ///< depth along the optical axis, 0 without a measurement [scene unit]
  Normals normals;      ///< camera frame, towards the sensor; NaN if unknown
  Column<std::uint8_t> plane;       ///< number of the pixel's dominant plane, from 1; 0: none
  Column<std::uint8_t> near_plane;  ///< number by position alone, whatever the normal: also along
                                    ///< the contact line of objects on it
};

/// Choose a virtual camera at `viewpoint` for scattered points; its optical axis passes through the
/// middle of the points.
///
/// pixel_size  size of a pixel at the middle of the points [scene unit]. 0: as fine as leaves about
///             two points on each occupied pixel, so that surfaces have few holes. This is right if
///             the points were seen from there; on a whole surface, points behind one another share
///             pixels. Points that many others coincide with count once
/// Neither side exceeds 2048 pixels. Points more than 75 degrees off the axis fall outside.
/// Empty for fewer than 3 points or points all in one place or direction.
std::optional<ImageGeometry> choose_camera(PointsView points, const Eigen::Vector3f& viewpoint,
                                           float pixel_size = 0);

/// Fill single missing pixels of a depth image between measured neighbors of similar depth, in
/// place. A pixel becomes the mean of its measured 8-neighbors if there are at least
/// `min_neighbors` of them, all within `max_step` of each other. Pixels on the image's border are
/// unchanged. Returns the number of filled pixels.
std::size_t fill_small_holes(const ImageGeometry& geometry, float max_step, int min_neighbors,
                             Column<float>& depth);

}  // namespace trivet::kernels
