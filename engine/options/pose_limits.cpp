#include "engine/options/pose_limits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace trivet {

bool PoseLimits::allow(const Pose& T_scene_model, const Eigen::Vector3f& model_center,
                       double scale) const noexcept {
  if (region) {
    const Eigen::Array3f center =
        (T_scene_model * model_center).array() * static_cast<float>(scale);
    if (!(center >= region->low.cast<float>().array()).all() ||
        !(center <= region->high.cast<float>().array()).all())
      return false;
  }
  if (tilt) {
    const Eigen::Vector3f turned = T_scene_model.linear() * tilt->model_direction;
    const float angle =
        std::atan2(turned.cross(tilt->scene_direction).norm(), turned.dot(tilt->scene_direction));
    if (!(angle <= tilt->max_angle_deg * (std::numbers::pi_v<float> / 180))) return false;
  }
  return true;
}

}  // namespace trivet
