/// Places and poses in the frame of a file, as exactly as it gives them, and in that of the cloud
/// read from it, which may have an offset (Cloud::offset).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "storage/data/model.hpp"

namespace trivet {

/// Model point -> point of the scene's file, in its unit. Whatever enters or leaves the program
/// speaks of this frame.
using FilePose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// offset  of the cloud that the pose is of
inline FilePose in_file_frame(const Pose& T_cloud_model, const Eigen::Vector3d& offset) {
  FilePose pose = T_cloud_model.cast<double>();
  pose.translation() += offset;
  return pose;
}

/// The pose in the frame of the cloud that has this offset.
inline Pose in_cloud_frame(const FilePose& T_file_model, const Eigen::Vector3d& offset) {
  FilePose pose = T_file_model;
  pose.translation() -= offset;
  return pose.cast<float>();
}

/// The place in the frame of the cloud that has this offset.
inline Eigen::Vector3f in_cloud_frame(const Eigen::Vector3d& place, const Eigen::Vector3d& offset) {
  return (place - offset).cast<float>();
}

}  // namespace trivet
