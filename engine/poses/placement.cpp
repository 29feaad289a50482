#include "engine/poses/placement.hpp"

#include "kernels/common/pose_math.hpp"

namespace trivet::engine {

bool same_placement(const ModelInfo& model, const Pose& a, const Pose& b) noexcept {
  const kernels::PoseDistance distance = kernels::pose_distance(a, b, model.symmetry, model.center);
  return distance.translation <= kRightTranslation * model.diameter &&
         distance.rotation_rad <= kRightRotationRad;
}

}  // namespace trivet::engine
