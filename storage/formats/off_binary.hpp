/// The binary form of OFF.
#pragma once

#include <cstddef>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"
#include "storage/formats/off_header.hpp"

namespace trivet::formats {

/// Read what stands behind the line "OFF BINARY", from this byte on: the three counts, the
/// vertices, and of each face the number of corners, the corners, the number of its color's
/// components, these. Integers and floats of 32 bits, most significant byte first.
/// Errors: bad_data.
Result<Cloud> read_off_binary(const Input& input, const OffKeyword& keyword, std::size_t begin);

}  // namespace trivet::formats
