/// Choice among poses of one model at one place that look alike.
#pragma once

#include "engine/loaded_library/recognizer.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Compare a tested pose with its alternatives: turns about the model's axis of near symmetry,
/// poses related by a near symmetry, and tested poses of the same model at the same place. The pose
/// moves to the turn and the alternative that the scan supports best, by the pixels where the
/// renderings differ (kernels::compare_turns, kernels::compare_poses). Alternatives that are not
/// significantly worse are noted; they lower its score if its shape does not explain them. The
/// table does not change.
///
/// Errors: internal (no memory for the model's ray-tracing tree).
Result<SettledPose> settle_alternatives(const Recognizer& recognizer, const TestedPoses& poses,
                                        const PoseTestOptions& options, Row row);

/// The pose that a tested pose moves to so, with its score before alternatives lower it. Errors: as
/// above.
Result<TestedPose> find_best_alternative(const Recognizer& recognizer, const TestedPoses& poses,
                                         const PoseTestOptions& options, Row row);

}  // namespace trivet::engine
