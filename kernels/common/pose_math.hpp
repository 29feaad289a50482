/// Operations on rigid transforms for clustering, refinement and selection.
#pragma once

#include <Eigen/Core>
#include <span>

#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Angle of the rotation from a to b [rad], in [0, pi].
float rotation_angle(const Eigen::Matrix3f& a, const Eigen::Matrix3f& b) noexcept;

/// Among `pose` and its symmetric equivalents, the one whose rotation is closest to `target`.
/// Equivalents describe the same placement of the object: pose * S for every symmetry S.
Pose closest_equivalent(const Pose& pose, const Symmetry& symmetry, const Pose& target) noexcept;

/// Distance of two placements of one object modulo its symmetry.
struct PoseDistance {
  float translation = 0;   ///< distance between the images of the model's center [scene unit]
  float rotation_rad = 0;  ///< [0, pi]; excludes the rotation about a symmetry axis
};
PoseDistance pose_distance(const Pose& a, const Pose& b, const Symmetry& symmetry,
                           const Eigen::Vector3f& model_center) noexcept;

/// Weighted mean. The rotation is the largest eigenvector of sum w q q^T (Markley et al., JGCD
/// 2007), independent of quaternion signs; the model's center maps to the weighted mean of its
/// images.
/// Pre: at least one pose, weights > 0; poses within one symmetric branch (closest_equivalent).
Pose mean_pose(std::span<const Pose> poses, std::span<const float> weights,
               const Eigen::Vector3f& model_center);

/// Transform that rotates by |w| about w through the point `pivot`, then shifts by t.
Pose small_motion(const Eigen::Vector3f& w, const Eigen::Vector3f& t,
                  const Eigen::Vector3f& pivot) noexcept;

}  // namespace trivet::kernels
