/// The position of a detection in a few digits.
#pragma once

#include <string>

#include "engine/results/recognize_result.hpp"

namespace trivet::apps {

/// "x, y, z" of the model's origin in the frame of the scene's file, to four digits of the position
/// without the offset.
///
/// offset  of the scene (SceneResult::offset)
std::string place_text(const Detection& detection, const Eigen::Vector3d& offset);

}  // namespace trivet::apps
