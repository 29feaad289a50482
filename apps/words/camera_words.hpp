/// What a check of a camera found, for people.
#pragma once

#include <optional>
#include <string>

#include "engine/results/camera_check.hpp"

namespace trivet::apps {

/// "the focal length looks 4.0 % too large; depths look 1.1 % too small"; nothing where the camera
/// is right as far as can be told.
std::optional<std::string> camera_finding(const CameraCheck& check);

}  // namespace trivet::apps
