/// Whether depths are along the axis or along the ray, determined by planes in the scene.
#pragma once

#include "engine/results/camera_check.hpp"
#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Find the largest plane in both readings. A reading is accepted if its plane is at least half as
/// large again as the other's and covers at least a seventh of the scene. In addition, the same
/// pixels must lie at least three times as far from a plane in the other reading. A table as wide
/// as a tenth of its distance suffices; noise, and planes that are small or seen at a small angle,
/// give no result.
///
/// camera  camera of the scene's only image
DepthReading check_depth_kind(const PreparedScene& scene, const Camera& camera);

}  // namespace trivet::engine
