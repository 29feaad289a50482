/// Removal of points and their attributes from a cloud.
#pragma once

#include <cstdint>
#include <span>

#include "storage/data/cloud.hpp"

namespace trivet {

/// Drop the points whose mark is 0, with their normals, intensities and the triangles that use
/// them; their pixels become pixels without a measurement. The others keep their order.
///
/// keep   one mark per point
void keep_points(std::span<const std::uint8_t> keep, Cloud& cloud);

}  // namespace trivet
