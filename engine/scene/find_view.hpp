/// Find out what saw a scene, and from where.
#pragma once

#include "engine/results/scene_view.hpp"
#include "engine/scene/read_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::engine {

/// By what the caller and the file say. Where they say nothing and there are triangles: by
/// visibility. A surface that turns one side to the origin was seen from there; one that turns
/// their front to a far place that its faces point to, from that place; of those left, one with
/// hardly any border is whole. Anything else is taken as seen from the origin.
///
/// Errors: bad_data (a viewpoint that is too far from the points for floats).
/// Returns the kind as `surface` or `points`; whether points form an image shows when they are
/// arranged in one.
Result<SceneView> find_view(const Cloud& cloud, const SceneInput& input);

}  // namespace trivet::engine
