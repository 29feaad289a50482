/// Depth by matching windows of a dot pattern, as in structured-light and active stereo cameras.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/simulation/measure_scene.hpp"

namespace trivet::engine {

/// Simulate the match. Each dot that both the camera and the light next to it see yields its
/// disparity f b / z with an independent error, and windows of dots vote
/// (kernels/simulation/match_windows). Waves, ripple, filters and quantization follow.
///
/// Parameters are those of measure_scene; flaws.match.half_window_pixel > 0.
/// Returns depths [m]; 0 for no measurement. Same bits for any number of threads.
std::vector<float> match_scene(const ExactScene& scene, const SensorOptions& options,
                               const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
