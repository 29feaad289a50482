/// Libraries made of models of another one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "storage/library.hpp"
#include "storage/result.hpp"

namespace trivet {

/// Write some models of a library into one of their own, with its principal components and
/// parameters, so that each is the same there.
///
/// models  indices, rising
/// Errors: bad_data (a model of the library is damaged), cannot_create, io.
Result<void> copy_models(const Library& library, std::span<const std::uint32_t> models,
                         const std::filesystem::path& file);

}  // namespace trivet
