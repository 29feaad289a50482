/// Preparation of a scan that a sensor took from one place.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// The error of a scan with fewer points than a search needs.
///
/// which  what the points are, after the word "points"; may be empty
Error too_few_points(const SceneInput& input, std::string_view which, std::size_t num_points);

/// Prepare a scan seen from scene.view.viewpoint.
///
/// recovered  geometry that the grid or the rays of the points determine [library unit]
Result<void> prepare_sensor_scene(const Cloud& cloud,
                                  const std::optional<kernels::ImageGeometry>& recovered,
                                  const SceneInput& input, const PrepareOptions& options,
                                  PreparedScene& scene);

}  // namespace trivet::engine
