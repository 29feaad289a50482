/// What the sure detections of depth images say of the camera that the user gave.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "kernels/verification/camera_scale.hpp"
#include "storage/cloud.hpp"

namespace trivet {

/// How well the camera that was given fits the objects that were found.
struct CameraCheck {
  Camera camera;                            ///< that the scene was recognized with
  std::vector<kernels::ScalePull> objects;  ///< the sure ones with enough surface
  std::size_t num_rays = 0;                 ///< that were shot for it
  /// What would fit the objects better; absent without any.
  std::optional<kernels::CameraScale> scale{};

  /// Whether the camera is off, beyond doubt and by what matters: three standard errors and 1.5 %
  /// of the focal length, by three objects at least; 0.75 % of depth, by two models at least, since
  /// a single one may be of another size than its model.
  bool focal_is_off() const noexcept;
  /// The same of the depth scale.
  bool depth_is_off() const noexcept;
};

/// The camera with what is off put right; nothing where nothing is.
std::optional<Camera> corrected_camera(const CameraCheck& check);

/// One check a camera, of all that its scenes hold; in the order in which cameras first come.
std::vector<CameraCheck> join_checks(std::span<const CameraCheck> scenes);

}  // namespace trivet
