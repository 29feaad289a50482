/// Scenes that could not be read or recognized, among others that were.
#pragma once

#include <cstddef>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps {

/// Success without any; the error of the only one; else one that tells all of them, under the code of
/// the first: "2 of 5 scenes failed, the others are told:" (if there are others) and a line each.
Result<void> failed_scenes(const std::vector<Error>& failures, std::size_t num_scenes);

}  // namespace trivet::apps
