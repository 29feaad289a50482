#include "apps/words/place_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/data/file_pose.hpp"

namespace trivet::apps {

std::string place_text(const Detection& detection, const Eigen::Vector3d& offset) {
  const Eigen::Vector3d t = in_file_frame(detection.T_scene_model, offset).translation();
  if (offset.isZero(0)) return fmt::format("{:.4g}, {:.4g}, {:.4g}", t.x(), t.y(), t.z());
  const float largest = detection.T_scene_model.translation().cwiseAbs().maxCoeff();
  const int decimals =
      largest > 0 ? std::clamp(4 - static_cast<int>(std::ceil(std::log10(largest))), 0, 9) : 0;
  return fmt::format("{0:.{3}f}, {1:.{3}f}, {2:.{3}f}", t.x(), t.y(), t.z(), decimals);
}

}  // namespace trivet::apps
