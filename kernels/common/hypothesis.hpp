/// A pose hypothesis.
#pragma once

#include "storage/data/model.hpp"

namespace trivet::kernels {

struct Hypothesis {
  Pose T_scene_model;
  float votes = 0;
};

}  // namespace trivet::kernels
