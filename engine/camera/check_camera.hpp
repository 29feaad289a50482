/// Check of a depth image's camera by the objects detected in it.
#pragma once

#include <span>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/results/camera_check.hpp"
#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Jointly fit the scales of the camera and the poses of the confident detections.
///
/// camera  camera of the scene's only image
/// Detections with a score from 0.9 and without alternatives are confident. The detections' poses
/// do not change. The check casts about 10,000 rays per object.
CameraCheck check_camera(const Recognizer& recognizer, const PreparedScene& scene,
                         const Camera& camera, const PoseTable& poses,
                         std::span<const Row> detections);

}  // namespace trivet::engine
