/// Proposals of a source of poses.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/options/method.hpp"
#include "kernels/common/hypothesis.hpp"

namespace trivet::engine {

/// Models of the library by sampling step. Models of one step share the sampled scene and its point
/// pair features.
using ModelGroups = std::map<float, std::vector<std::uint32_t>>;

/// Poses of one model from one source.
struct Proposals {
  std::uint32_t model = 0;  ///< index in the library
  Source source = Source::ppf;
  std::vector<kernels::Hypothesis> hypotheses;
};

}  // namespace trivet::engine
