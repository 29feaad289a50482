/// Picture of a single model, for lists of models.
#pragma once

#include <cstdint>

#include "kernels/common/ray_scene.hpp"
#include "storage/data/points.hpp"
#include "storage/formats/write_png.hpp"

namespace trivet {

/// Draw the model from the side and above, lit as in the pictures of scenes, on a pale background.
///
/// surface  surface of the model
/// around   points that must be in the picture, at least one
/// width    width of the square picture [pixel], > 0
Picture draw_model(const kernels::RayScene& surface, PointsView around, std::uint32_t width);

}  // namespace trivet
