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
  bool fortran_order;                ///< the first index runs fastest, not the last
  std::vector<std::uint64_t> shape;  ///< all above zero; as many values as the body holds
  std::size_t body_begin;            ///< [byte]
};

/// Read versions 1.0, 2.0 and 3.0. The header is a Python dictionary; what is no literal of the
/// three entries that NumPy writes is refused, and nothing is evaluated.
/// Errors: bad_data (what is no array of plain numbers, or not as long as its header says).
/// Source: NumPy Enhancement Proposal 1, "A simple file format for NumPy arrays".
Result<NpyHeader> parse_npy_header(const Input& input);

}  // namespace trivet::formats
