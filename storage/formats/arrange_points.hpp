/// From the numbers of an array to a cloud: of NumPy files and of arrays in memory.
#pragma once

#include <cstdint>

#include "storage/files/input.hpp"
#include "storage/formats/positions.hpp"

namespace trivet::formats {

/// Place the points; those of more than one row and one column, row by row, make a pixel grid seen
/// from the origin, in which the points at (0, 0, 0) are none.
///
/// normals   none, or one a point
/// Pre: positions.size() == width * height, at most Input::max_points().
Cloud arrange_points(Positions positions, Positions normals, std::uint32_t width,
                     std::uint32_t height, const Input& input);

}  // namespace trivet::formats
