/// Poses from votes of the scene's point pair features.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "engine/hypotheses/proposals.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/options/recognize_options.hpp"
#include "engine/results/recognize_result.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/scene/sample_scene.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Source of poses by voting. The scene is sampled once per sampling step, when models of that step
/// are first voted for.
class VoteSource {
 public:
  /// Keeps references to all arguments.
  ///
  /// groups  all models to search for; the largest one of a step decides which planes may vote
  /// stats   receives times and counts
  VoteSource(const Recognizer& recognizer, const PreparedScene& scene, const ModelGroups& groups,
             LargePlanes large_planes, SceneStats& stats);

  /// Vote for models. Only references whose model could lie within the limits vote.
  ///
  /// models     a subset of the groups, by sampling step; a step without models is skipped
  /// max_pairs  of a reference and a model it votes for, over all steps; of more, a like share of the
  ///            references of each step votes
  /// explained  nonzero for pixels whose points do not vote, images concatenated; empty: none
  /// Errors: damaged.
  Result<std::vector<Proposals>> propose(const ModelGroups& models, const VoteOptions& options,
                                         std::size_t max_pairs, const PoseLimits& limits,
                                         std::span<const std::uint8_t> explained);

 private:
  std::vector<SceneLevel> choose_all_voters(const ModelGroups& models, const VoteOptions& options,
                                            const PoseLimits& limits,
                                            std::span<const std::uint8_t> explained);

  const Recognizer& recognizer_;
  const PreparedScene& scene_;
  const ModelGroups& groups_;
  const LargePlanes large_planes_;
  SceneStats& stats_;
  std::map<float, SceneSample> samples_;  // keyed by sampling step
};

}  // namespace trivet::engine
