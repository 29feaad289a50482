/// How a scene was understood, for people.
#pragma once

#include <optional>
#include <string>

#include "engine/results/scene_view.hpp"

namespace trivet::apps {

/// "taken as seen from the origin; if the sensor stood elsewhere, give its viewpoint"; nothing where
/// the caller or the file said what saw the scene.
std::optional<std::string> view_words(const SceneView& view);

}  // namespace trivet::apps
