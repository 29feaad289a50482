/// Bodies seen by a small camera, for tests of verification.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "kernels/common/ray_scene.hpp"
#include "kernels/scans/range_image.hpp"
#include "kernels/surfaces/model_samples.hpp"
#include "support/rendered_scene.hpp"
#include "support/shapes.hpp"

namespace trivet::test {

/// Depth of a wall behind everything.
inline constexpr float kFar = 2;

/// Shapes seen by a small camera at the origin, each a model.
struct Body {
  Shape shape;
  kernels::RayScene surface;
  kernels::ModelSamples samples;

  Body(Shape of, float diameter)
      : shape(std::move(of)),
        surface(*kernels::RayScene::from_mesh(shape.vertices, shape.triangles)) {
    samples.points = shape.vertices;
    samples.diameter = diameter;
    samples.spacing = 0;
  }
  explicit Body(const Eigen::Vector3f& half) : Body(box(-half, half), 2 * half.norm()) {}
};

/// A round rod along x.
inline Body rod_of(float radius, float half_length) {
  const Shape upright = prism(96, circle(static_cast<double>(radius)),
                              -static_cast<double>(half_length), static_cast<double>(half_length));
  return {upright.moved(pose_of({0, 1.5707963F, 0}, {0, 0, 0})),
          2 * std::hypot(radius, half_length)};
}

inline kernels::ImageGeometry camera() {
  return {Pose::Identity(), 150, 150, 79.5F, 59.5F, 160, 120};
}

/// The depth image of bodies in front of a wall.
inline kernels::RangeImage render(const std::vector<std::pair<const Body*, Pose>>& bodies,
                                  float wall = kFar,
                                  const kernels::ImageGeometry& geometry = camera()) {
  kernels::RangeImage image;
  image.geometry = geometry;
  const std::size_t n = std::size_t{image.geometry.width} * image.geometry.height;
  image.depth.assign(n, wall);
  image.plane.assign(n, 0);
  image.near_plane.assign(n, 0);
  image.normals.resize(n);
  for (std::size_t pixel = 0; pixel < n; ++pixel)
    image.normals.set(pixel, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (std::size_t pixel = 0; pixel < n; ++pixel) {
    const Eigen::Vector3f ray = image.geometry.back_project(pixel, 1);
    for (const auto& [body, pose] : bodies) {
      const Pose inverse = pose.inverse();
      const kernels::Hit hit = body->surface.intersect(
          inverse.translation(), inverse.linear() * ray, 0, std::numeric_limits<float>::infinity());
      if (hit && (image.depth[pixel] == 0 || hit.distance < image.depth[pixel]))
        image.depth[pixel] = hit.distance;
    }
  }
  return image;
}

/// A box that is seen well.
inline const Body& brick() {
  static const Body body({0.1F, 0.06F, 0.04F});
  return body;
}

/// The two triangles of the brick's front: a part of its surface, as a scan of it is.
inline const Body& front_of_brick() {
  Shape front;
  front.add({-0.1F, -0.06F, -0.04F}, {-0.1F, 0.06F, -0.04F}, {0.1F, 0.06F, -0.04F},
            {0.1F, -0.06F, -0.04F});
  static const Body body(std::move(front), brick().samples.diameter);
  return body;
}

}  // namespace trivet::test
