/// Preparation of a whole surface that no single place sees.
#pragma once

#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Prepare a surface that is visible from all around.
///
/// triangles  triangles of scene.points
Result<void> prepare_closed_scene(const Triangles& triangles, const SceneInput& input,
                                  const PrepareOptions& options, PreparedScene& scene);

}  // namespace trivet::engine
