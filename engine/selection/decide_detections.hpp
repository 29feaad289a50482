/// From tested poses to detections.
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
  bool alternatives = true;   ///< compare what is chosen with what looks like it
  bool require_pose = false;  ///< min_score is asked of score * pose_share
  Among among = Among::few_models;
  /// Whether votes had the chance to propose each pose: one that matches alone propose is less
  /// likely then.
  bool votes_first = true;
  bool operator==(const DecideOptions&) const = default;
};

/// Compare what was chosen with its alternatives and rivals, and refuse what then lies where a
/// better one does, or falls below the score that is asked for; what that one alone hid is compared
/// in its stead.
///
/// tested     rows of the table that were tested in full
/// selection  of these; it gets the reasons of all refusals
/// table      gets the settled poses and the fate of all rows
/// Returns the rows of the detections in the order of choice.
/// Errors: internal (no memory for a model's ray-tracing tree).
Result<std::vector<Row>> decide_detections(const Recognizer& recognizer, const PreparedScene& scene,
                                           std::span<const Row> tested,
                                           const DecideOptions& options, Selection& selection,
                                           PoseTable& table);

}  // namespace trivet::engine
