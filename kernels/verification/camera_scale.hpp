/// Check of stated camera parameters, by the objects found with them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/verification/object_scale.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// Information of one object on the log scales of its camera (focal, depth), with its pose
/// eliminated.
struct ScalePull {
  std::uint32_t model = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();     ///< information times the log scales
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();  ///< covariance of the pull, by its blocks
  float correlation = 0;  ///< correlation of the scan's errors from pixel to pixel, 0..1
};

/// Eliminate the pose from the equations of an object, linearized at `scales`.
ScalePull leave_pose_free(const ObjectEquations& equations, const LogScales& scales);

/// The best-fitting pose after the scales change by `step` from the point of linearization.
Pose follow_scales(const ObjectEquations& equations, const LogScales& step,
                   const Pose& T_camera_model, const Eigen::Vector3f& model_center);

/// A factor and its standard error.
struct Factor {
  double value = 1, error = 0;
};

/// Correction factors of a camera's focal lengths and depths.
struct CameraScale {
  Factor focal;
  std::optional<Factor> depth;  ///< empty if neighboring pixels err alike
  double num_models = 0;        ///< effective number of models, by their shares of the information
};

/// The scales that fit all objects best. Their order does not matter, except for rounding.
///
/// Standard errors are the largest of those by blocks of pixels, by objects and by models, each of
/// which may err as a unit; a term for the deviation of a model from the surface is added. Cameras
/// that match windows round off curved surfaces, as a wrong scale of depth would. For these, depth
/// is assumed to be right, and the focal length is known to 2 % over the square root of the number
/// of models. Source of the errors: White, Econometrica 48(4), 1980, for groups instead of single
/// residuals.
CameraScale estimate_scales(std::span<const ScalePull> objects);

}  // namespace trivet::kernels
