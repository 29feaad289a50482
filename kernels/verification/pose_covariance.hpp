/// How far off a pose may be: its covariance by the measurements that hold it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "kernels/verification/examine_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Covariance of a small motion of a posed model in its own frame, about its center: translation
/// along x, y, z [unit], then the rotation vector [rad]. The true pose is the estimate, followed by
/// this motion.
using PoseCovariance = Eigen::Matrix<float, 6, 6, Eigen::DontAlign>;

/// The covariance of a pose by what holds it.
///
/// radius  half the model's diameter [unit]. What no measurement holds may be off by as much.
/// shared  standard deviation of what all measurements of the object may be off together, which no
///         number of them reduces [unit]
/// axis    an axis of the model about which it is symmetric: turns about it are no errors
/// Source: Censi, ICRA 2007 (the inverse of the information at the optimum).
PoseCovariance pose_covariance(const PoseEquations& equations, const Pose& T_scene_model,
                               const Eigen::Vector3f& center, float radius, float shared,
                               const std::optional<Symmetry::Axis>& axis);

/// Standard deviations along and about the model's axes: three lengths, three angles [rad].
Eigen::Matrix<float, 6, 1> pose_sigma(const PoseCovariance& covariance) noexcept;

/// Standard deviation of the position in its least certain direction.
float largest_shift(const PoseCovariance& covariance);

}  // namespace trivet::kernels
