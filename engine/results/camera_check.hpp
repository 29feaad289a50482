/// Check of the user's camera against the confident detections in depth images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "kernels/verification/camera_scale.hpp"
#include "storage/data/cloud.hpp"

namespace trivet {

/// Check of the kind of depth by large flat surfaces. Depths along the axis and depths along the
/// ray are two readings of the same values: a surface that is flat in one reading is curved in the
/// other.
struct DepthReading {
  std::uint32_t num_as_said = 0;  ///< scenes with a surface that is flat in the camera's reading
  /// Scenes with a surface that is flat in the other reading and curved in the camera's.
  std::uint32_t num_otherwise = 0;
  /// Root mean square of the distances to the plane in the camera's reading and in the other one,
  /// in the library's unit, for the surface of the scene where they differ most.
  float curved = 0, flat = 0;

  bool operator==(const DepthReading&) const = default;
};

/// How well the given camera agrees with the detected objects and with planes.
struct CameraCheck {
  Camera camera;                            ///< camera that the scene was recognized with
  std::vector<kernels::ScalePull> objects;  ///< confident detections with enough surface
  std::size_t num_rays = 0;                 ///< number of rays cast for the check
  /// Scale that fits the objects better; absent without objects.
  std::optional<kernels::CameraScale> scale{};
  DepthReading depth{};

  /// Whether the focal length is off, both significantly and by an amount that matters. This
  /// requires three standard errors and 1.5 % of the focal length with at least three objects. For
  /// depth, the limit is 0.75 % with at least two models, since a single object may differ in size
  /// from its model.
  bool focal_is_off() const noexcept;
  /// Whether the depth scale is off, by the limits above.
  bool depth_is_off() const noexcept;
  /// Whether depths are not of the camera's kind, by most scenes that distinguish the two.
  bool depth_kind_is_off() const noexcept { return depth.num_otherwise > depth.num_as_said; }
};

/// The camera with its errors corrected; absent if it has none.
std::optional<Camera> corrected_camera(const CameraCheck& check);

/// Combine the checks of scenes that share a camera. Returns one check per camera, in the order in
/// which cameras first occur.
std::vector<CameraCheck> join_checks(std::span<const CameraCheck> scenes);

}  // namespace trivet
