/// Error model of a scan's sensor, measured in its image.
#pragma once

#include "engine/scene/prepare_scene.hpp"

namespace trivet::engine {

/// Measure how the sensor's error depends on range and how it is shared by neighboring pixels.
/// Noise and correlated noise are already measured.
void measure_sensor(const kernels::RangeImage& image, const PrepareOptions& options,
                    kernels::SensorModel& sensor);

}  // namespace trivet::engine
