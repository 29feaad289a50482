/// Models of a library that look like another one.
#pragma once

#include <cstdint>
#include <vector>

#include "storage/library.hpp"

namespace trivet::engine {

/// Where another model lies when it looks like this one.
struct LookAlike {
  std::uint32_t model = 0;  ///< of the library
  Pose T_model_other = Pose::Identity();
};

/// Match features of a model, spread over it, with those of all others of its resolution;
/// matches that agree on where another model lies make it a look-alike. The alikest come first, at
/// most forty.
/// index  of the features of all models of the library
/// Same bytes for any number of threads. Errors: bad_data (damaged).
Result<std::vector<LookAlike>> find_look_alikes(const Library& library, const FeatureIndex& index,
                                                std::uint32_t model);

}  // namespace trivet::engine
