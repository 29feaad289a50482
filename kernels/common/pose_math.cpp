#include "kernels/common/pose_math.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "storage/common/precondition.hpp"

namespace trivet::kernels {

float rotation_angle(const Eigen::Matrix3f& a, const Eigen::Matrix3f& b) noexcept {
  // |R - I|_F = 2 sqrt(2) sin(angle / 2): well conditioned near 0, unlike the trace.
  const float s = (a - b).norm() / 2.8284271247F;
  return 2 * std::asin(std::min(1.0F, s));
}

namespace {

/// Rotate about the free axis so that the rotation is closest to the target's.
Pose turn_about_axis(const Pose& pose, const Symmetry::Axis& axis, const Pose& target) noexcept {
  // Maximize trace(R_t^T R Rot(axis, angle)): with M = R_t^T R, the sum is c + a cos + b sin.
  const Eigen::Matrix3f M = target.linear().transpose() * pose.linear();
  const Eigen::Vector3f d = axis.direction;
  Eigen::Matrix3f cross;
  cross << 0, -d.z(), d.y(), d.z(), 0, -d.x(), -d.y(), d.x(), 0;
  const float along = d.dot(M * d);
  const float cosine = M.trace() - along;
  const float sine = (M * cross).trace();
  const float angle = std::atan2(sine, cosine);
  const Eigen::Matrix3f turn = Eigen::AngleAxisf(angle, d).toRotationMatrix();
  Pose S = Pose::Identity();
  S.linear() = turn;
  const Eigen::Vector3f p = axis.point;
  S.translation() = p - turn * p;
  return pose * S;
}

}  // namespace

Pose closest_equivalent(const Pose& pose, const Symmetry& symmetry, const Pose& target) noexcept {
  Pose best = pose;
  float best_angle = 4;
  const auto consider = [&](const Pose& candidate) {
    const Pose turned =
        symmetry.axis ? turn_about_axis(candidate, *symmetry.axis, target) : candidate;
    const float angle = rotation_angle(turned.linear(), target.linear());
    if (angle < best_angle) {
      best = turned;
      best_angle = angle;
    }
  };
  consider(pose);
  for (const Pose& S : symmetry.poses) consider(pose * S);
  return best;
}

PoseDistance pose_distance(const Pose& a, const Pose& b, const Symmetry& symmetry,
                           const Eigen::Vector3f& model_center) noexcept {
  const Pose near = symmetry.trivial() ? b : closest_equivalent(b, symmetry, a);
  return {(a * model_center - near * model_center).norm(),
          rotation_angle(a.linear(), near.linear())};
}

Pose mean_pose(std::span<const Pose> poses, std::span<const float> weights,
               const Eigen::Vector3f& model_center) {
  TRIVET_REQUIRE(!poses.empty() && poses.size() == weights.size(), "one weight per pose");
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double sum = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double w = weights[i];
    const Eigen::Vector4d q = Eigen::Quaternionf(poses[i].linear()).coeffs().cast<double>();
    scatter += w * q * q.transpose();
    center += w * (poses[i] * model_center).cast<double>();
    sum += w;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(scatter);
  const Eigen::Quaterniond mean(Eigen::Vector4d(solver.eigenvectors().col(3)));
  Pose out = Pose::Identity();
  out.linear() = mean.normalized().toRotationMatrix().cast<float>();
  out.translation() = (center / sum).cast<float>() - out.linear() * model_center;
  return out;
}

Pose small_motion(const Eigen::Vector3f& w, const Eigen::Vector3f& t,
                  const Eigen::Vector3f& pivot) noexcept {
  Pose motion = Pose::Identity();
  const float angle = w.norm();
  if (angle > 0) motion.linear() = Eigen::AngleAxisf(angle, w / angle).toRotationMatrix();
  motion.translation() = pivot + t - motion.linear() * pivot;
  return motion;
}

}  // namespace trivet::kernels
