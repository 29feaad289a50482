/// Conversion of the numbers of an array, from a NumPy file or memory, to a cloud.
#pragma once

#include <cstdint>

#include "storage/files/input.hpp"
#include "storage/formats/positions.hpp"

namespace trivet::formats {

/// Place the points. More than one row and one column, row by row, make a pixel grid seen from the
/// origin, in which points at (0, 0, 0) are missing measurements.
///
/// normals   empty, or one per point
/// Pre: positions.size() == width * height, at most Input::max_points().
Cloud arrange_points(Positions positions, Positions normals, std::uint32_t width,
                     std::uint32_t height, const Input& input);

}  // namespace trivet::formats
