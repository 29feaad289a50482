/// Depth by matching windows of a pattern of dots, as cameras of structured light and of active
/// stereo do it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/simulation/measure_scene.hpp"

namespace trivet::engine {

/// Simulate the match: each dot that both the camera and the light beside it see tells its
/// disparity f b / z with an error of its own; windows of dots vote
/// (kernels/simulation/match_windows); waves, ripple, filters and steps follow.
///
/// Parameters as of measure_scene; flaws.match.half_window_pixel > 0.
/// Returns depths [m]; 0 for no measurement. Same bits for any number of threads.
std::vector<float> match_scene(const ExactScene& scene, const SensorOptions& options,
                               const SensorFlaws& flaws, std::uint64_t seed, std::uint64_t stream);

}  // namespace trivet::engine
