/// Positions and poses in the frame of a file, with the precision of the file, and in the frame of
/// the cloud read from it, which may have an offset (Cloud::offset).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "storage/data/model.hpp"

namespace trivet {

/// Transform from the model to the scene's file, in the file's unit. All input and output of the
/// program uses this frame.
using FilePose = Eigen::Transform<double, 3, Eigen::Isometry, Eigen::DontAlign>;

/// offset  offset of the cloud in whose frame the pose is given
inline FilePose in_file_frame(const Pose& T_cloud_model, const Eigen::Vector3d& offset) {
  FilePose pose = T_cloud_model.cast<double>();
  pose.translation() += offset;
  return pose;
}

/// The pose in the frame of a cloud with this offset.
inline Pose in_cloud_frame(const FilePose& T_file_model, const Eigen::Vector3d& offset) {
  FilePose pose = T_file_model;
  pose.translation() -= offset;
  return pose.cast<float>();
}

/// The position in the frame of a cloud with this offset.
inline Eigen::Vector3f in_cloud_frame(const Eigen::Vector3d& place, const Eigen::Vector3d& offset) {
  return (place - offset).cast<float>();
}

}  // namespace trivet
