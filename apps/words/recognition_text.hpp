/// The result of a recognition as text for a terminal.
#pragma once

#include <string>
#include <vector>

#include "engine/recognition/recognize.hpp"
#include "engine/results/camera_check.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

/// A line for the scene and one for each detection. Without detections, advice on what to check.
/// Lengths in the scene's unit.
///
/// min_score  lowest score of detections
std::string scene_text(const SceneInput& scene, const SceneResult& result, const Library& library,
                       float min_score);

/// Advice when nothing was found: sentences that the page of the service shows, too.
std::vector<std::string> advice_on_nothing(const SceneInput& scene, const SceneResult& result,
                                           const Library& library, float min_score);

/// A line if the camera seems wrong, else nothing.
std::string camera_text(const CameraCheck& check);

}  // namespace trivet::apps
