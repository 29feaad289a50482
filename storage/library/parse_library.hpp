/// From a file's tree to a library: for those who read files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

#include "storage/library/library.hpp"
#include "storage/library/stored_tree.hpp"

namespace trivet {

/// Check everything that a library promises, and take it: versions, checksums, index ranges.
///
/// file   told in errors
/// bytes  that the offsets of `root` count in; the tables stay in them
/// owner  keeps them alive
/// Errors: bad_data (names the dataset and the bound it broke).
Result<Library> parse_library(const std::filesystem::path& file, const StoredGroup& root,
                              std::span<const std::byte> bytes,
                              const std::shared_ptr<const std::byte>& owner);

}  // namespace trivet
