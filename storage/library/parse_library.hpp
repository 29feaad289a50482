/// Conversion of a file's tree to a library, for readers of files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "storage/library/library.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// Check everything that the format guarantees (versions, checksums, index ranges), and build the
/// library.
///
/// file   named in errors
/// bytes  bytes relative to which the offsets of `root` are given; the tables stay in them
/// owner  keeps the bytes alive
/// Errors: bad_data (names the dataset and the violated bound).
Result<Library> parse_library(const std::filesystem::path& file, const StoredGroup& root,
                              std::span<const std::byte> bytes,
                              const std::shared_ptr<const std::byte>& owner);

}  // namespace trivet
