/// Choose the set of detections that together explain the scene.
#pragma once

#include <vector>

#include "engine/candidate.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/recognise.hpp"

namespace trivet::engine {

/// Take candidates by falling score x area^0.25 (large surfaces prove more), each unless a better
/// one already explains more than max_overlap of its pixels: copies of one object fall out whatever
/// their symmetry, and of two objects claiming one place the better explained stays. Ties go to the
/// earlier candidate. Doubtful candidates come after all others. scene_scale: the scene was
/// multiplied by it; poses and lengths are given in the scene's own unit.
std::vector<Detection> select_detections(const Library& library, const PreparedScene& scene,
                                         std::vector<Candidate> candidates,
                                         const RecogniseOptions& options, double scene_scale);

}  // namespace trivet::engine
