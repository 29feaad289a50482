/// The assumed viewpoint of a scene, in words.
#pragma once

#include <optional>
#include <string>

#include "engine/results/scene_view.hpp"

namespace trivet::apps {

/// "treated as seen from the origin; if the sensor stood elsewhere, give its viewpoint"; none if
/// the caller or the file gave the viewpoint.
std::optional<std::string> view_words(const SceneView& view);

}  // namespace trivet::apps
