/// Kind and viewpoint of a scene.
#pragma once

#include "engine/results/scene_view.hpp"
#include "engine/scene/read_scene.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"

namespace trivet::engine {

/// Determine the view from the caller and the file. If they give none and there are triangles, it
/// follows from visibility. A surface that turns one side to the origin was seen from there. A
/// surface whose faces point to a far place and turn their fronts to it was seen from that place.
/// Any other surface with almost no border is a whole surface. In all other cases the origin is
/// assumed.
///
/// Errors: bad_data (a viewpoint that is too far from the points for floats).
/// Returns the kind as `surface` or `points`; whether points form an image is decided later, when
/// they are arranged in one.
Result<SceneView> find_view(const Cloud& cloud, const SceneInput& input);

}  // namespace trivet::engine
