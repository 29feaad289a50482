/// Sampling of a scene for a set of models.
#pragma once

#include <cstdint>
#include <span>

#include "engine/scene/prepare_scene.hpp"
#include "engine/scene/sample_scene.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Sample a scene at `step` for models of the library. The largest model decides which planes are
/// too large to be part of one.
SceneSample sample_for_models(const Library& library, const PreparedScene& scene, float step,
                              std::span<const std::uint32_t> models, LargePlanes large_planes);

}  // namespace trivet::engine
