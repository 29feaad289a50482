#include "kernels/symmetry/turn_axis.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace trivet::kernels {

using Eigen::Vector3f;

namespace {

constexpr std::size_t kTurnQueries = 200;
constexpr float kMinAlong = 0.9F;  // cosine; rotations that refinement moved elsewhere are ignored

}  // namespace

Pose turn_about(const Symmetry::Axis& axis, float angle) noexcept {
  const Vector3f direction = axis.direction, point = axis.point;
  Pose result = Pose::Identity();
  result.linear() = Eigen::AngleAxisf(angle, direction).toRotationMatrix();
  result.translation() = point - result.linear() * point;
  return result;
}

Symmetry::Axis axis_of(const Pose& motion) noexcept {
  const Eigen::AngleAxisf rotation(Eigen::Matrix3f(motion.linear()));
  const Vector3f a = rotation.axis();
  const Vector3f t = motion.translation();
  const Vector3f across = t - a * a.dot(t);
  // The fixed point of the rotation in the plane perpendicular to the axis: p = (t + cot(angle / 2)
  // a x t) / 2.
  return {a, 0.5F * (across + a.cross(across) / std::tan(0.5F * rotation.angle()))};
}

Symmetry::Axis refine_axis(const SampledSurface& surface, const Symmetry::Axis& axis,
                           std::span<const float> angles) noexcept {
  Vector3f direction = Vector3f::Zero(), point = Vector3f::Zero();
  float weights = 0;
  for (const float angle : angles) {
    const Symmetry::Axis refined =
        axis_of(surface.refine(turn_about(axis, angle), kTurnQueries, 2));
    const Vector3f refined_direction = refined.direction;
    const float along = refined_direction.dot(axis.direction);
    if (!(std::abs(along) > kMinAlong)) continue;
    const float weight = std::abs(std::sin(0.5F * angle));
    direction += refined_direction * (along < 0 ? -weight : weight);
    point += weight * refined.point;
    weights += weight;
  }
  if (weights == 0) return axis;
  return {direction.normalized(), point / weights};
}

}  // namespace trivet::kernels
