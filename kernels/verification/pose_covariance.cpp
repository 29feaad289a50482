#include "kernels/verification/pose_covariance.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace trivet::kernels {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// The motion by a turn about an axis of the model, in the order of PoseCovariance.
Vector6 turn_about(const Symmetry::Axis& axis, const Eigen::Vector3f& center) {
  const Eigen::Vector3f direction = axis.direction.normalized();
  const Eigen::Vector3f shift = direction.cross(center - Eigen::Vector3f(axis.point));
  Vector6 turn;
  turn << shift.cast<double>(), direction.cast<double>();
  return turn;
}

}  // namespace

PoseCovariance pose_covariance(const PoseEquations& equations, const Pose& T_scene_model,
                               const Eigen::Vector3f& center, float radius, float shared,
                               const std::optional<Symmetry::Axis>& axis) {
  const auto length = static_cast<double>(radius);
  // The equations' unknowns are a turn in radii and a translation, both in the scene's frame.
  const double off = static_cast<double>(shared);
  Matrix6 scene = (equations.held + Matrix6::Identity() / (length * length)).inverse();
  scene.diagonal().array() += off * off;
  const Eigen::Matrix3d R_model_scene = T_scene_model.linear().cast<double>().transpose();
  Matrix6 to_model = Matrix6::Zero();
  to_model.topRightCorner<3, 3>() = R_model_scene;
  to_model.bottomLeftCorner<3, 3>() = R_model_scene / length;
  Matrix6 covariance = to_model * scene * to_model.transpose();
  if (axis) {
    const Vector6 turn = turn_about(*axis, center);
    Vector6 dual = Vector6::Zero();  // tells how much of a motion is a turn about the axis
    dual.tail<3>() = turn.tail<3>();
    const Matrix6 rest = Matrix6::Identity() - turn * dual.transpose();
    covariance = rest * covariance * rest.transpose();
  }
  return covariance.cast<float>();
}

Eigen::Matrix<float, 6, 1> pose_sigma(const PoseCovariance& covariance) noexcept {
  return covariance.diagonal().cwiseMax(0).cwiseSqrt();
}

float largest_shift(const PoseCovariance& covariance) {
  const Eigen::Matrix3f shifts = covariance.topLeftCorner<3, 3>();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(shifts, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0F, solver.eigenvalues()(2)));
}

}  // namespace trivet::kernels
