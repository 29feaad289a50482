/// The header of a PCD file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "storage/files/input.hpp"
#include "storage/files/scalar.hpp"

namespace trivet::formats {

struct PcdField {
  std::string name;
  Scalar type = Scalar::float32;
  std::uint64_t count = 1;   ///< values per point
  std::uint64_t offset = 0;  ///< byte offset of the first value in a binary point
  std::uint64_t column = 0;  ///< word index of the first value in a text point
};

enum class PcdEncoding { ascii, binary, binary_compressed };

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t point_bytes = 0;                        ///< size of a binary point, at most 2^32
  std::uint64_t point_columns = 0;                      ///< values per point
  std::uint64_t width = 0, height = 1, num_points = 0;  ///< width * height == num_points
  Eigen::Vector3d viewpoint{0, 0, 0};
  PcdEncoding encoding = PcdEncoding::ascii;
  std::size_t body_begin = 0;  ///< first byte after the header
  std::size_t body_line = 1;   ///< line number of the body

  /// The field of that name with one value per point, or null.
  const PcdField* find(std::string_view name) const noexcept;
};

/// Errors: bad_data (also for a header of more than 64 kB).
Result<PcdHeader> parse_pcd_header(const Input& input);

}  // namespace trivet::formats
