/// The checks of what several models have in the file, side by side.
#pragma once

#include <cstdint>
#include <span>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// Check a part of each model, as Library::check does; what has to be read is asked for first, all
/// at once. Errors: bad_data, of the first model that is damaged.
Result<void> check_models(const Library& library, std::span<const std::uint32_t> models,
                          ModelPart part);

}  // namespace trivet::engine
