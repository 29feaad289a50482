/// What the sure detections of depth images say of the camera that the user gave.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels/verification/camera_scale.hpp"
#include "storage/data/cloud.hpp"

namespace trivet {

/// What large flat surfaces say of what depths measure: along the axis and along the ray the same
/// values are flat in one reading and curved in the other.
struct DepthReading {
  std::uint32_t num_as_said = 0;    ///< scenes with a surface that is flat as the camera says
  std::uint32_t num_otherwise = 0;  ///< ... that is flat in the other reading, and curved in this
  /// Of such a surface: root mean square of the distances to its plane as the camera says, and
  /// otherwise, in the library's unit; of the scene where they differ most.
  float curved = 0, flat = 0;

  bool operator==(const DepthReading&) const = default;
};

/// How well the camera that was given fits the objects that were found, and the planes.
struct CameraCheck {
  Camera camera;                            ///< that the scene was recognized with
  std::vector<kernels::ScalePull> objects;  ///< the sure ones with enough surface
  std::size_t num_rays = 0;                 ///< that were shot for it
  /// What would fit the objects better; absent without any.
  std::optional<kernels::CameraScale> scale{};
  DepthReading depth{};

  /// Whether the camera is off, beyond doubt and by what matters: three standard errors and 1.5 %
  /// of the focal length, by three objects at least; 0.75 % of depth, by two models at least, since
  /// a single one may be of another size than its model.
  bool focal_is_off() const noexcept;
  /// The same of the depth scale.
  bool depth_is_off() const noexcept;
  /// Whether depths are not along what the camera says, in most scenes that tell.
  bool depth_kind_is_off() const noexcept { return depth.num_otherwise > depth.num_as_said; }
};

/// The camera with what is off put right; nothing where nothing is.
std::optional<Camera> corrected_camera(const CameraCheck& check);

/// One check a camera, of all that its scenes hold; in the order in which cameras first come.
std::vector<CameraCheck> join_checks(std::span<const CameraCheck> scenes);

}  // namespace trivet
