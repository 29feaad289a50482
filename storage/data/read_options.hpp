/// How files of geometry are read.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "storage/data/cloud.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet {

/// How a file is to be read, and how much of it at most.
struct ReadOptions {
  std::optional<Camera> camera{};  ///< needed for depth images, ignored otherwise
  /// What coordinates are wanted in. Formats that say their unit, as glTF does, are converted to it;
  /// the others are taken to be in it. Absent: each file stays in its own.
  std::optional<LengthUnit> unit{};
  /// Read how bright points are, where the file tells: PCD, PLY and text do.
  bool intensity = false;
  std::string_view format{};                  ///< one of cloud_extensions(); empty: as below
  std::uint64_t max_file_bytes = 4ULL << 30;  ///< larger files are refused, packed or unpacked
  std::uint64_t max_points = 100'000'000;     ///< more points are refused
  std::uint64_t max_pixels = 64'000'000;      ///< larger depth images are refused before decoding
  /// Of models, whose poses speak of the file's origin: subtract no offset, and refuse points so far
  /// from the origin that floats would be too coarse.
  bool keep_origin = false;
};

}  // namespace trivet
