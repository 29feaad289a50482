/// gzip, as files and bodies come packed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// Whether bytes begin as gzip does.
bool is_gzip(std::span<const std::byte> bytes) noexcept;

/// Unpack all members of a gzip file. They are gone through twice: measured and checked first, so
/// that what unpacks to too much, is truncated or damaged takes no memory.
///
/// name   stands for the file in messages
/// Errors: bad_data (more than max_bytes, truncated, damaged, other bytes behind it; each with the
/// place). Throws std::bad_alloc.
/// Source: Deutsch, GZIP file format specification version 4.3, RFC 1952.
Result<std::vector<std::byte>> gunzip(std::span<const std::byte> packed, std::string_view name,
                                      std::uint64_t max_bytes);

}  // namespace trivet
