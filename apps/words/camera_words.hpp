/// The result of a check of a camera, in words.
#pragma once

#include <optional>
#include <string>

#include "engine/results/camera_check.hpp"

namespace trivet::apps {

/// "the focal length looks 4.0 % too large; depths look 1.1 % too small"; none if no error of the
/// camera was detected.
std::optional<std::string> camera_finding(const CameraCheck& check);

}  // namespace trivet::apps
