/// Check the camera of one depth image by what was found in it.
#pragma once

#include <span>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/results/camera_check.hpp"
#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Fit the scales of the camera and the poses of the sure ones among the detections together.
///
/// camera  of the scene's only image
/// Detections from a score of 0.9 without alternatives are sure. The poses that were found stay as
/// they are. Some 10,000 rays an object.
CameraCheck check_camera(const Recognizer& recognizer, const PreparedScene& scene,
                         const Camera& camera, const PoseTable& poses,
                         std::span<const Row> detections);

}  // namespace trivet::engine
