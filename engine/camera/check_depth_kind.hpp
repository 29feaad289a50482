/// Whether depths are along the axis or along the ray, by the planes that a scene shows.
#pragma once

#include "engine/results/camera_check.hpp"
#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Find the largest plane in both readings. One is believed where its plane is half as large again as
/// the other's and has a seventh of the scene at least, and where the same pixels lie at least three
/// times as far from a plane in the other reading. A table as wide as a tenth of its distance tells;
/// noise, and planes that are small or seen under a small angle, say nothing.
///
/// camera  of the scene's only image
DepthReading check_depth_kind(const PreparedScene& scene, const Camera& camera);

}  // namespace trivet::engine
