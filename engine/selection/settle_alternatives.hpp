/// Choose among poses of one model in one place that look alike.
#pragma once

#include <span>

#include "engine/loaded_library/recognizer.hpp"
#include "engine/scene/prepare_scene.hpp"
#include "engine/verification/candidate.hpp"
#include "engine/verification/pose_tester.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// Hold a candidate against its alternatives: turns about the model's near axis, poses that a near
/// symmetry leads to, and `candidates` of the same model in the same place. It moves to the turn
/// and the alternative that the scan speaks for, by the pixels where the renderings differ
/// (kernels::compare_turns, kernels::compare_poses); alternatives that are not significantly worse
/// are noted, and lower its score if its shape does not explain them.
///
/// step  of the points that voted [library unit]
/// Errors: internal (no memory for the model's ray-tracing tree).
Result<void> settle_alternatives(const Recognizer& recognizer, const PreparedScene& scene,
                                 float step, std::span<const Candidate> candidates,
                                 const PoseTestOptions& options, Candidate& candidate);

}  // namespace trivet::engine
