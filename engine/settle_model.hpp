/// From the hypotheses of one model to verified candidates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/candidate.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/recognise.hpp"
#include "engine/recogniser.hpp"
#include "kernels/cluster_poses.hpp"
#include "storage/result.hpp"

namespace trivet::engine {

/// Cluster the hypotheses of one model, look at each, refine the best, test those by rays and score
/// them. `step` is the sampling step of the points that voted. Errors: internal (no memory for the
/// model's ray-tracing tree).
Result<std::vector<Candidate>> settle_model(const Recogniser& recogniser, std::uint32_t model_index,
                                            const PreparedScene& scene, float step,
                                            std::span<const kernels::Hypothesis> hypotheses,
                                            const RecogniseOptions& options, SceneStats& stats);

/// Hold a candidate against its rivals: poses that a near symmetry of the model leads to, and
/// `candidates` of the same model in the same place. It moves to a rival that the scan speaks
/// for, by the pixels where the renderings differ (kernels::compare_poses); rivals that are not
/// significantly worse are noted. Errors: as settle_model.
Result<void> settle_rivals(const Recogniser& recogniser, const PreparedScene& scene, float step,
                           std::span<const Candidate> candidates, const RecogniseOptions& options,
                           SceneStats& stats, Candidate& candidate);

}  // namespace trivet::engine
