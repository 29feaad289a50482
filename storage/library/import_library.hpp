/// Libraries that another program has stored anew.
#pragma once

#include <filesystem>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet {

/// Read a library that was chunked, compressed or otherwise repacked, after the checks of
/// open_library; all of it is in memory then. Written with copy_models, it has the bytes that it
/// had before, if this version of the format wrote it.
/// Errors: missing_input, bad_data (names the object; a newer format, of which something would be
/// lost), io.
Result<Library> read_repacked_library(const std::filesystem::path& file);

}  // namespace trivet
