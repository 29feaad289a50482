/// Parts without symmetry and depth scans of them, rendered in memory with known poses.
#pragma once

#include <vector>

#include "kernels/scans/render_depth.hpp"
#include "storage/data/cloud.hpp"
#include "support/shapes.hpp"

namespace trivet::test {

/// A part without any symmetry, some 0.2 m large: a base, a pillar, a fin and a knob.
inline Shape bracket() {
  Shape shape = box({-0.08F, -0.05F, 0}, {0.08F, 0.05F, 0.02F});
  shape.join(box({-0.07F, -0.04F, 0.02F}, {-0.03F, 0.01F, 0.11F}));
  shape.join(box({-0.03F, -0.02F, 0.02F}, {0.05F, -0.005F, 0.06F}));
  shape.join(ellipsoid({0.025F, 0.02F, 0.03F}, 24)
                 .moved(Pose(Eigen::Translation3f(0.045F, 0.025F, 0.035F))));
  return shape;
}

/// Another part without symmetry, of similar size.
inline Shape lever() {
  Shape shape = ellipsoid({0.1F, 0.02F, 0.015F}, 24);
  shape.join(box({0.03F, -0.045F, -0.012F}, {0.07F, 0, 0.012F}));
  Shape boss = prism(24, circle(1), 0, 1);
  for (std::size_t i = 0; i < boss.vertices.size(); ++i) {
    const Eigen::Vector3f p = boss.vertices[i];
    boss.vertices.set(i, {-0.06F + 0.025F * p.x(), 0.025F * p.y(), -0.03F + 0.06F * p.z()});
  }
  shape.join(boss);
  return shape;
}

inline Cloud cloud_of(const Shape& shape) {
  Cloud cloud;
  cloud.points = shape.vertices;
  cloud.triangles = shape.triangles;
  return cloud;
}

/// A pose from a rotation vector [rad] and a translation.
inline Pose pose_of(const Eigen::Vector3f& rotation, const Eigen::Vector3f& translation) {
  Pose pose = Pose::Identity();
  if (rotation.norm() > 0) {
    pose.linear() = Eigen::AngleAxisf(rotation.norm(), rotation.normalized()).toRotationMatrix();
  }
  pose.translation() = translation;
  return pose;
}

struct Placed {
  const Shape* shape;
  Pose T_camera_shape;
};

/// A VGA depth scan of placed shapes in the camera's frame, which is that of the scene.
Cloud render_scan(const std::vector<Placed>& placed);

}  // namespace trivet::test
