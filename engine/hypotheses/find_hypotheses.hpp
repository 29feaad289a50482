/// From a sampled scene to poses that point pairs vote for.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "kernels/common/hypothesis.hpp"
#include "storage/library/library.hpp"

namespace trivet::engine {

struct VotedHypotheses {
  std::vector<std::vector<kernels::Hypothesis>> of_model;  ///< each in the order of the references
  std::uint64_t num_references = 0, num_pairs = 0, num_votes = 0;
};

/// Every reference point of the level votes for every model of `models`, which share its sampling
/// step.
VotedHypotheses find_hypotheses(const Library& library, const SceneLevel& level,
                                std::span<const std::uint32_t> models, const VoteOptions& options);

}  // namespace trivet::engine
