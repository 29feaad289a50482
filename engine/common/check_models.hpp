/// Parallel checks of several models' data in the file.
#pragma once

#include <cstdint>
#include <span>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Check a part of each model, like Library::check. All necessary data is requested first, in one
/// batch. Errors: bad_data, for the first damaged model.
Result<void> check_models(const Library& library, std::span<const std::uint32_t> models,
                          ModelPart part);

}  // namespace trivet::engine
