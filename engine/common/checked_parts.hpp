/// Parts of models, checked; of several in parallel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/surfaces/model_samples.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

/// A part of each model, as Library::samples and Library::pairs give it. All necessary data is
/// requested first, in one batch. Errors: damaged, for the first such model.
Result<std::vector<const ModelSamples*>> samples_of(const Library& library,
                                                    std::span<const std::uint32_t> models);
Result<std::vector<const ModelPairs*>> pairs_of(const Library& library,
                                                std::span<const std::uint32_t> models);

/// The samples of a model for kernels. Errors: damaged.
Result<kernels::ModelSamples> kernel_samples(const Library& library, std::uint32_t model);

}  // namespace trivet::engine
