/// Find out what saw a scene, and from where.
#pragma once

#include "engine/recognize.hpp"
#include "engine/scene_view.hpp"
#include "storage/cloud.hpp"

namespace trivet::engine {

/// By what the caller and the file say. Where they say nothing and there are triangles: by
/// visibility. A surface that turns one side to the origin was seen from there; one that turns
/// their front to a far place that its faces point to, from that place; of those left, one with
/// hardly any border is whole. Anything else is taken as seen from the origin.
///
/// Returns the kind as `surface` or `points`; whether points form an image shows when they are
/// arranged in one.
SceneView find_view(const Cloud& cloud, const SceneInput& input);

}  // namespace trivet::engine
