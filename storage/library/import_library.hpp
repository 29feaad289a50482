/// Import of libraries that another program has rewritten.
#pragma once

#include <filesystem>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// Read a library that was chunked, compressed or otherwise repacked, with the checks of
/// open_library. The whole library is loaded into memory. Writing it with copy_models restores the
/// original bytes, if this version of the format wrote it.
/// Errors: missing_input, bad_data (names the object; a newer format, from which data would be
/// lost), io.
Result<Library> read_repacked_library(const std::filesystem::path& file);

}  // namespace trivet
