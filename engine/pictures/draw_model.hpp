/// A picture of a model alone, for lists of models.
#pragma once

#include <cstdint>

#include "kernels/common/ray_scene.hpp"
#include "storage/data/points.hpp"
#include "storage/formats/write_png.hpp"

namespace trivet {

/// The model from above its side, lit as in the pictures of scenes, on a pale ground.
///
/// surface  of the model
/// around   points that the picture shall hold, at least one
/// width    of the square picture [pixel], > 0
Picture draw_model(const kernels::RayScene& surface, PointsView around, std::uint32_t width);

}  // namespace trivet
