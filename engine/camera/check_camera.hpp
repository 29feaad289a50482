/// Check the camera of one depth image by what was found in it.
#pragma once

#include <span>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/results/camera_check.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"

namespace trivet::engine {

/// Fit the scales of the camera and the poses of the sure ones among `found` together.
///
/// camera  of the scene's only image
/// Candidates from a score of 0.9 without alternatives are sure. The poses that were found stay as
/// they are. Some 10,000 rays an object.
CameraCheck check_camera(const Recognizer& recognizer, const PreparedScene& scene,
                         const Camera& camera, std::span<const Candidate> found);

}  // namespace trivet::engine
