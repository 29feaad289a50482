#include "engine/verification/candidate.hpp"

#include "kernels/common/pose_math.hpp"

namespace trivet::engine {

float scale_odds(float probability, float factor) noexcept {
  return factor * probability / (1 - probability + factor * probability);
}

bool same_placement(const Model& model, const Pose& a, const Pose& b) noexcept {
  const kernels::PoseDistance distance = kernels::pose_distance(a, b, model.symmetry, model.center);
  return distance.translation <= kRightTranslation * model.diameter &&
         distance.rotation_rad <= kRightRotationRad;
}

}  // namespace trivet::engine
