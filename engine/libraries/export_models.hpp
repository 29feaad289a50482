/// Surfaces of a library's models as files that other programs read.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet {

/// Write vertices and triangles of models as FOLDER/NAME.ply, in the library's unit.
///
/// names  none: all models
/// Returns the files. Errors: usage (no such model), bad_data (damaged), cannot_create, io.
Result<std::vector<std::filesystem::path>> export_models(const Library& library,
                                                         std::span<const std::string> names,
                                                         const std::filesystem::path& folder);

}  // namespace trivet
