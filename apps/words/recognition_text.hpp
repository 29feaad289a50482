/// The result of a recognition as text for a terminal.
#pragma once

#include <string>
#include <string_view>
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

/// A sentence on what to check when nothing was found.
struct Advice {
  std::string_view about;  ///< "measurements", "rejected", "sizes", "camera" or "viewpoint"
  std::string words;
};
std::vector<Advice> advice_on_nothing(const SceneInput& scene, const SceneResult& result,
                                      const Library& library, float min_score);

/// A line if the camera seems wrong, else nothing.
std::string camera_text(const CameraCheck& check);

}  // namespace trivet::apps
