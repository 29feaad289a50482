/// Parts of a library that is too large for one machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet {

/// Indices of the models of each part: about equal in bytes of what is searched, none empty. Models
/// of one sampling step stay together where that allows it, since a scene is sampled once for each
/// step.
/// num_parts  1 to the number of models
std::vector<std::vector<std::uint32_t>> split_models(const Library& library, std::size_t num_parts);

/// Write the parts as FOLDER/STEM-1.h5 and so on, STEM being that of the library's file; all share
/// its principal components and parameters, so a model is the same in them.
/// Returns the files. Errors: usage (the number of parts), cannot_create, io.
Result<std::vector<std::filesystem::path>> split_library(const Library& library,
                                                         std::size_t num_parts,
                                                         const std::filesystem::path& folder);

}  // namespace trivet
