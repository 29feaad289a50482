/// Choose the set of detections that together explain the scene.
#pragma once

#include <cstdint>
#include <vector>

#include "engine/prepare_scene.hpp"
#include "engine/recognise.hpp"
#include "kernels/verify_pose.hpp"

namespace trivet::engine {

/// A verified pose of one model.
struct Candidate {
  std::uint32_t model = 0;
  Pose T_scene_model = Pose::Identity();
  kernels::Evidence evidence;
  float score = 0;
  std::vector<std::uint32_t> explained;  ///< pixels of the agreeing samples, over all images
};

/// Take candidates by falling score x area^0.25 (large surfaces prove more), each unless a better
/// one already explains more than max_overlap of its pixels: copies of one object fall out whatever
/// their symmetry, and of two objects claiming one place the better explained stays. Ties go to the
/// earlier candidate. Doubtful candidates come after all others. scene_scale: the scene was
/// multiplied by it; poses and lengths are given in the scene's own unit.
std::vector<Detection> select_detections(const Library& library, const PreparedScene& scene,
                                         std::vector<Candidate> candidates,
                                         const RecogniseOptions& options, double scene_scale);

}  // namespace trivet::engine
