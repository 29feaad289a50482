/// Decompression of gzip files and message bodies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// Whether bytes begin with the gzip magic number.
bool is_gzip(std::span<const std::byte> bytes) noexcept;

/// Decompress all members of a gzip file in two passes. The first measures and checks, so that data
/// that is too large, truncated or damaged takes no memory.
///
/// name   stands for the file in messages
/// Errors: bad_data (more than max_bytes, truncated, damaged, other bytes after the last member;
/// each with the position). Throws std::bad_alloc.
/// Source: Deutsch, GZIP file format specification version 4.3, RFC 1952.
Result<std::vector<std::byte>> gunzip(std::span<const std::byte> packed, std::string_view name,
                                      std::uint64_t max_bytes);

}  // namespace trivet
