/// How large a scan is, before it is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "storage/formats/read_cloud.hpp"

namespace trivet {

/// What a file says of its size.
struct DeclaredSize {
  std::uint64_t num_points = 0;      ///< or pixels, and triangles
  std::uint64_t unpacked_bytes = 0;  ///< of what gzip packed, else 0
};

/// How large the cloud of these bytes may be, without reading it: by their header, or by their
/// length where that does not tell. At most what the options allow. What gzip packed is taken to be
/// as long as its last member says.
DeclaredSize declared_size(std::span<const std::byte> bytes, const std::filesystem::path& name,
                           const ReadOptions& options = {});

}  // namespace trivet
