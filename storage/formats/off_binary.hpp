/// The binary form of OFF.
#pragma once

#include <cstddef>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"
#include "storage/formats/off_header.hpp"

namespace trivet::formats {

/// Read the part after the line "OFF BINARY", from this byte on. It holds the three counts, the
/// vertices, and for each face the number of corners, the corners, the number of color components
/// and these components. Integers and floats have 32 bits, most significant byte first.
/// Errors: bad_data.
Result<Cloud> read_off_binary(const Input& input, const OffKeyword& keyword, std::size_t begin);

}  // namespace trivet::formats
