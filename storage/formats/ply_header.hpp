/// The header of a PLY file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "storage/files/input.hpp"
#include "storage/files/scalar.hpp"

namespace trivet::formats {

struct PlyProperty {
  std::string name;
  Scalar type = Scalar::float32;
  std::optional<Scalar> count_type;  ///< type of the count; present for a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { ascii, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::uint64_t num_cols = 0, num_rows = 0;  ///< size of Stanford's range_grid, from obj_info
  std::size_t body_begin = 0;                ///< first byte after end_header and its line break
  std::size_t body_line = 1;                 ///< line number of the body

  const PlyElement* find(std::string_view name) const noexcept;
};

/// Errors: bad_data (also for a header of more than 64 kB).
Result<PlyHeader> parse_ply_header(const Input& input);

}  // namespace trivet::formats
