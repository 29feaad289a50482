/// From the hypotheses of one model to verified candidates.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/candidate.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/recognise.hpp"
#include "kernels/cluster_poses.hpp"
#include "storage/library.hpp"

namespace trivet::engine {

/// Cluster the hypotheses of one model, look at each, refine the best and verify those. `step` is
/// the sampling step of the points that voted.
std::vector<Candidate> settle_model(const Library& library, std::uint32_t model_index,
                                    const PreparedScene& scene, float step,
                                    std::span<const kernels::Hypothesis> hypotheses,
                                    const RecogniseOptions& options, SceneStats& stats);

}  // namespace trivet::engine
