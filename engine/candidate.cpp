#include "engine/candidate.hpp"

#include "kernels/pose_math.hpp"

namespace trivet::engine {

bool same_placement(const Model& model, const Pose& a, const Pose& b) noexcept {
  constexpr float kTranslation = 0.1F, kRotationRad = 12 * 3.14159265358979F / 180;
  const kernels::PoseDistance distance = kernels::pose_distance(a, b, model.symmetry, model.centre);
  return distance.translation <= kTranslation * model.diameter &&
         distance.rotation_rad <= kRotationRad;
}

}  // namespace trivet::engine
