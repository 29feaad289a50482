/// Depth images of posed meshes, one ray per pixel.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "storage/data/model.hpp"

namespace trivet::test {

/// Depths of a surface in each of the poses in front of a wall perpendicular to the optical axis,
/// which is plane 0. There are no normals.
inline kernels::RangeImage measure(const kernels::ImageGeometry& geometry,
                                   const kernels::RayScene& surface, std::span<const Pose> poses,
                                   float wall) {
  kernels::RangeImage image;
  image.geometry = geometry;
  const std::size_t n = std::size_t{geometry.width} * geometry.height;
  image.depth.assign(n, wall);
  image.plane.assign(n, 0);
  image.normals.resize(n);
  for (std::size_t pixel = 0; pixel < n; ++pixel) {
    const Eigen::Vector3f ray = geometry.back_project(pixel, 1);
    for (const Pose& pose : poses) {
      const Pose inverse = pose.inverse();
      const kernels::Hit hit = surface.intersect(inverse.translation(), inverse.linear() * ray, 0,
                                                 std::numeric_limits<float>::infinity());
      if (hit) image.depth[pixel] = std::min(image.depth[pixel], hit.distance);
    }
  }
  return image;
}

}  // namespace trivet::test
