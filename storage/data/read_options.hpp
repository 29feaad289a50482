/// Options for reading geometry files.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "storage/data/cloud.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet {

/// Format options and size limits for reading a file.
struct ReadOptions {
  std::optional<Camera> camera{};  ///< needed for depth images, ignored otherwise
  /// Target unit of coordinates. Formats with a stated unit, such as glTF, are converted to it;
  /// other formats are assumed to use it. Absent: coordinates stay in the file's unit.
  std::optional<LengthUnit> unit{};
  /// Whether to read the intensity of points where the format has it (PCD, PLY and text).
  bool intensity = false;
  std::string_view format{};  ///< one of cloud_extensions(); empty: chosen as for read_cloud
  std::uint64_t max_file_bytes = 4ULL << 30;  ///< larger files are refused, compressed or
                                              ///< decompressed
  std::uint64_t max_points = 100'000'000;     ///< more points are refused
  std::uint64_t max_pixels = 64'000'000;      ///< larger depth images are refused before decoding
  /// For models, whose poses refer to the file's origin: subtract no offset, and refuse points so
  /// far from the origin that floats would be too coarse.
  bool keep_origin = false;
};

}  // namespace trivet
