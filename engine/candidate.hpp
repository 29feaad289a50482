/// A pose of a model on its way from hypothesis to detection.
#pragma once

#include <cstdint>
#include <vector>

#include "kernels/verify_pose.hpp"
#include "storage/model.hpp"

namespace trivet::engine {

/// A verified pose of one model.
struct Candidate {
  std::uint32_t model = 0;
  Pose T_scene_model = Pose::Identity();
  kernels::Evidence evidence;
  float score = 0;
  std::vector<std::uint32_t> explained;  ///< pixels of the agreeing samples, over all images
};

}  // namespace trivet::engine
