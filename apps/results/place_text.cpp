#include "apps/results/place_text.hpp"

#include <fmt/format.h>

#include "storage/file_pose.hpp"

namespace trivet::apps {

std::string place_text(const Detection& detection, const Eigen::Vector3d& offset) {
  const Eigen::Vector3d t = in_file_frame(detection.T_scene_model, offset).translation();
  const int digits = offset.isZero(0) ? 4 : 10;
  return fmt::format("{:.{}g}, {:.{}g}, {:.{}g}", t.x(), digits, t.y(), digits, t.z(), digits);
}

}  // namespace trivet::apps
