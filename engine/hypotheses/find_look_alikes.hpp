/// Models of a library that look like another one.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/hypotheses/feature_library.hpp"
#include "storage/library.hpp"

namespace trivet::engine {

/// Where another model lies when it looks like this one.
struct LookAlike {
  std::uint32_t model = 0;  ///< of the library
  Pose T_model_other = Pose::Identity();
};

/// Match features of a model, spread over it, with those of all others of its level; matches that
/// agree on where another model lies make it a look-alike. The alikest come first, at most forty.
/// levels  of index_features
/// Same bytes for any number of threads.
std::vector<LookAlike> find_look_alikes(const Library& library,
                                        const std::vector<FeatureLevel>& levels,
                                        std::uint32_t model);

}  // namespace trivet::engine
