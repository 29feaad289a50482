/// Search of one scene: rounds of proposals, and selection among all verified poses.
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

/// Result of a search. Poses and lengths are in the scene's frame, in the library's unit.
struct SearchResult {
  PoseTable poses;              ///< all poses with their fates
  std::vector<Row> detections;  ///< sorted in the order of choice
  std::vector<Row> rejected;    ///< the best rejected poses of each model, by falling score
  /// Present if the user asked about a place.
  std::optional<std::vector<ExplainedModel>> explained{};
};

/// Test the expected poses, then search round by round. Choose the tested poses that together
/// explain the scene, and compare them with hypotheses that look like them.
///
/// scene    receives the smoothing of its sensor, which the first poses tell
/// stats    receives times and counts
/// Errors: internal (no memory for ray tracing), damaged. Throws Stopped.
Result<SearchResult> search_scene(const Recognizer& recognizer, PreparedScene& scene,
                                  const SearchPlan& plan, SceneStats& stats);

}  // namespace trivet::engine
