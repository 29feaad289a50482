/// What recognition found, for a person at a terminal.
#pragma once

#include <string>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "engine/results/camera_check.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

/// A line for the scene and one for each detection; where there is none, what to check. Lengths in
/// the scene's unit.
///
/// min_score  that detections must have
std::string scene_text(const SceneInput& scene, const SceneResult& result, const Library& library,
                       float min_score);

/// What to check when nothing was found: sentences, which the page of the service has, too.
std::vector<std::string> advice_on_nothing(const SceneInput& scene, const SceneResult& result,
                                           const Library& library, float min_score);

/// A line where the camera looks wrong, else nothing.
std::string camera_text(const CameraCheck& check);

}  // namespace trivet::apps
