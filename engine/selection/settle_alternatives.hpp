/// Choose among poses of one model in one place that look alike.
#pragma once

#include "engine/loaded_library/recognizer.hpp"
#include "engine/selection/select_poses.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Compare a tested pose with its alternatives: turns about the model's near axis, poses that a near
/// symmetry leads to, and tested poses of the same model in the same place. It moves to the turn
/// and the alternative that the scan speaks for, by the pixels where the renderings differ
/// (kernels::compare_turns, kernels::compare_poses); alternatives that are not significantly worse
/// are noted, and lower its score if its shape does not explain them. The table stays as it is.
///
/// Errors: internal (no memory for the model's ray-tracing tree).
Result<SettledPose> settle_alternatives(const Recognizer& recognizer, const TestedPoses& poses,
                                        const PoseTestOptions& options, Row row);

}  // namespace trivet::engine
