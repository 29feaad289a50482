/// Errors of scenes that could not be read or recognized, among others that were.
#pragma once

#include <cstddef>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Success without any failure. A single error is returned as it is. Several become one error with
/// the code of the first and a line for each, after "2 of 5 scenes failed, the others are
/// reported:" if there are other scenes.
Result<void> failed_scenes(const std::vector<Error>& failures, std::size_t num_scenes);

}  // namespace trivet::apps
