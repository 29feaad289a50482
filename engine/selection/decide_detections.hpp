/// Decision on which tested poses become detections.
#pragma once

#include <vector>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/poses/pose_table.hpp"
#include "engine/results/stage_times.hpp"
#include "engine/selection/other_answers.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

struct DecideOptions {
  SelectOptions select{};
  PoseTestOptions test{};
  /// Whether to compare chosen poses with hypotheses that look like them.
  bool alternatives = true;
  bool require_pose = false;      ///< whether min_score applies to score * pose_share
  bool require_identity = false;  ///< whether min_score applies to score * share of the model
  /// Whether voting could have proposed each pose. If so, a pose that only matches propose is less
  /// likely.
  bool votes_first = true;
  bool operator==(const DecideOptions&) const = default;
};

/// Compare the chosen poses with their alternatives and rivals. A pose is refused if it then lies
/// where a better one does, or if its score falls below the required minimum. Poses that were
/// hidden by a refused pose alone are compared in its place.
///
/// tested     rows of the table that were tested in full
/// selection  selection of these rows; receives the reasons of all refusals
/// table      receives the settled poses and the fate of all rows
/// Returns the rows of the detections in the order of choice.
/// Errors: internal (no memory for a model's ray-tracing tree).
Result<std::vector<Row>> decide_detections(const Recognizer& recognizer, const PreparedScene& scene,
                                           std::span<const Row> tested,
                                           const DecideOptions& options, Selection& selection,
                                           PoseTable& table);

}  // namespace trivet::engine
