/// The search of one scene: rounds of proposals, and the choice among all that was verified.
#pragma once

#include <optional>
#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/recognition/explain_place.hpp"
#include "engine/recognition/search_plan.hpp"
#include "engine/results/recognize_result.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Poses and lengths are in the scene's frame, in the library's unit.
struct SearchResult {
  PoseTable poses;              ///< all, with their fates
  std::vector<Row> detections;  ///< in the order of choice
  std::vector<Row> rejected;    ///< the best of each model, by falling score
  std::optional<std::vector<ExplainedModel>> explained{};  ///< if a place was asked about
};

/// Test the expected poses, then search round by round; of all tested poses choose those that
/// explain the scene together, and compare these with what looks like them.
///
/// stats    gets times and counts
/// Errors: internal (no memory for ray tracing), bad_data (damaged). Throws Stopped.
Result<SearchResult> search_scene(const Recognizer& recognizer, const PreparedScene& scene,
                                  const SearchPlan& plan, SceneStats& stats);

}  // namespace trivet::engine
