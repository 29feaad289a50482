/// The size of a scan, before it is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

#include "storage/formats/read_cloud.hpp"

namespace trivet {

/// Size according to the file's header.
struct DeclaredSize {
  std::uint64_t num_points = 0;      ///< number of points or pixels, and triangles
  std::uint64_t unpacked_bytes = 0;  ///< decompressed size of a gzip file, otherwise 0
};

/// Upper bound of the size of the cloud in these bytes, without reading it: from the header, or
/// from the length if the header does not state it. At most the limits of the options. The
/// decompressed size of gzip data is assumed to be the one in its last member.
DeclaredSize declared_size(std::span<const std::byte> bytes, const std::filesystem::path& name,
                           const ReadOptions& options = {});

}  // namespace trivet
