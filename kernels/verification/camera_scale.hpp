/// Whether a camera is as it was said to be, by the objects that were found with it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "kernels/verification/object_scale.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// What an object says of the log scales of its camera (focal, depth), whatever its pose is.
struct ScalePull {
  std::uint32_t model = 0;
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d pull = Eigen::Vector2d::Zero();     ///< information times the log scales
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();  ///< covariance of the pull, by its blocks
  float correlation = 0;  ///< of the scan's errors from pixel to pixel, 0..1
};

/// Eliminate the pose from the equations of an object, set up at `scales`.
ScalePull leave_pose_free(const ObjectEquations& equations, const LogScales& scales);

/// The pose that fits best once the scales change by `step` from where the equations were set up.
Pose follow_scales(const ObjectEquations& equations, const LogScales& step,
                   const Pose& T_camera_model, const Eigen::Vector3f& model_center);

/// A factor and its standard error.
struct Factor {
  double value = 1, error = 0;
};

/// What a camera's focal lengths and depths are to be multiplied by.
struct CameraScale {
  Factor focal;
  std::optional<Factor> depth;  ///< none where neighboring pixels err alike
  double num_models = 0;        ///< that tell, by their shares of the information
};

/// The scales that fit all objects best. Their order does not matter, but for rounding.
///
/// Errors are the largest of those by blocks of pixels, by objects and by models, each of which may
/// err as one, and beside it what the surfaces of a model may differ from it. Cameras that match
/// windows round off what is curved, as a wrong scale of depth would: of these, depth is taken as
/// it is, and the focal length is known to 2 %, over the root of the number of models. Source of
/// the errors: White, Econometrica 48(4), 1980, for groups instead of single residuals.
CameraScale estimate_scales(std::span<const ScalePull> objects);

}  // namespace trivet::kernels
