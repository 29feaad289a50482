/// Parts of several models, checked in parallel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// A part of each model, as Library::samples and Library::pairs give it. All necessary data is
/// requested first, in one batch. Errors: bad_data, for the first damaged model.
Result<std::vector<const ModelSamples*>> samples_of(const Library& library,
                                                    std::span<const std::uint32_t> models);
Result<std::vector<const ModelPairs*>> pairs_of(const Library& library,
                                                std::span<const std::uint32_t> models);

}  // namespace trivet::engine
