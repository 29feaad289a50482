/// Models of a library that look like another one.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/hypotheses/feature_library.hpp"
#include "storage/library.hpp"

namespace trivet::engine {

/// Where another model lies when it looks like this one.
struct Sibling {
  std::uint32_t model = 0;  ///< of the library
  Pose T_model_sibling = Pose::Identity();
};

/// Match features of a model, spread over it, with those of all others of its level; matches that
/// agree on where another model lies make it a sibling. The alikest come first, at most forty.
/// levels  of index_features
/// Same bytes for any number of threads.
std::vector<Sibling> find_siblings(const Library& library, const std::vector<FeatureLevel>& levels,
                                   std::uint32_t model);

}  // namespace trivet::engine
