/// The header of a NumPy array file.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/files/input.hpp"
#include "storage/files/scalar.hpp"

namespace trivet::formats {

struct NpyHeader {
  Scalar type;
  std::endian order;
  bool fortran_order;                ///< column-major order: the first index varies fastest
  std::vector<std::uint64_t> shape;  ///< sizes, all above zero; their product is the number of
                                     ///< values in the body
  std::size_t body_begin;            ///< [byte]
};

/// Read versions 1.0, 2.0 and 3.0. The header is a Python dictionary. Anything but literals of the
/// three entries that NumPy writes is refused, and nothing is evaluated.
/// Errors: bad_data (not an array of plain numbers, or not of the length in its header).
/// Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays".
Result<NpyHeader> parse_npy_header(const Input& input);

}  // namespace trivet::formats
