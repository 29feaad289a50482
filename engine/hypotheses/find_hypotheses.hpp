/// Voting for poses by point pair features of a sampled scene.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/options/recognize_options.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/scene/sample_scene.hpp"
#include "kernels/common/hypothesis.hpp"
#include "storage/data/model.hpp"

namespace trivet::engine {

struct VotedHypotheses {
  /// Hypotheses per model, in the order of the references.
  std::vector<std::vector<kernels::Hypothesis>> of_model;
  std::uint64_t num_references = 0, num_pairs = 0, num_votes = 0;
};

/// Let every reference point of the level vote for every model. These share its sampling step.
VotedHypotheses find_hypotheses(std::span<const ModelPairs* const> models, const SceneLevel& level,
                                const VoteOptions& options);

}  // namespace trivet::engine
