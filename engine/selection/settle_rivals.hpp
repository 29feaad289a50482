/// Competition between models that claim the same place.
#pragma once

#include "engine/selection/compare_rivals.hpp"
#include "engine/selection/select_poses.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// A selection prefers high score and large area, which are weak evidence between models that look
/// alike. Therefore a chosen pose yields its place to a hidden model with at least half its score
/// if that model is likelier (compare_rivals). The new pose is then compared with the remaining
/// rivals.
/// Errors: internal (no memory for a model's ray-tracing tree).
Result<void> settle_rivals(RivalComparisons& comparisons, const TestedPoses& poses,
                           Selection& selection);

/// Give the place of a chosen pose to another one that it hides.
///
/// refused  the refusals; that of the winner becomes the loser's
void exchange(Row loser, Row winner, std::vector<Refusal>& refused);

}  // namespace trivet::engine
