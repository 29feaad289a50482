/// Models that claim one place compete for it.
#pragma once

#include "engine/loaded_library/recognizer.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// A selection takes what its score and its area put first; of models that look alike, both say
/// little. So a chosen pose gives its place to a model that it hides, of at least half its score,
/// if that one is the likelier by the pixels where their renderings differ and the scores
/// (rival_log_odds); that one defends the place against the rest.
/// Errors: internal (no memory for a model's ray-tracing tree).
Result<void> settle_rivals(const Recognizer& recognizer, const TestedPoses& poses,
                           const PoseTestOptions& test, Selection& selection);

}  // namespace trivet::engine
