/// What is known beforehand of where the models lie.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "storage/data/file_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Poses beyond the limits are neither searched for nor reported.
struct PoseLimits {
  /// A box along the axes of the frame.
  struct Region {
    Eigen::Vector3d low{0, 0, 0}, high{0, 0, 0};
    bool operator==(const Region&) const = default;
  };
  /// How far a direction of the model may turn from one of the scene.
  struct Tilt {
    Eigen::Vector3f model_direction{0, 0, 1}, scene_direction{0, 0, 1};  ///< of any length > 0
    float max_angle_deg = 180;
    bool operator==(const Tilt&) const = default;
  };
  std::optional<Region> region{};  ///< box that holds the models' centers [file's frame and unit]
  std::optional<Tilt> tilt{};      ///< the model's direction is within this angle of the scene's
  bool operator==(const PoseLimits&) const = default;

  /// Whether a pose with this center is within the limits. scale: of the given lengths to the
  /// region's unit.
  bool allow(const Pose& T_scene_model, const Eigen::Vector3f& model_center,
             double scale) const noexcept;
};

/// A pose that may be expected, as of an earlier scene.
struct ExpectedPose {
  std::string model;
  FilePose T_scene_model = FilePose::Identity();

  bool operator==(const ExpectedPose& other) const {
    return model == other.model && T_scene_model.matrix() == other.T_scene_model.matrix();
  }
};

}  // namespace trivet
