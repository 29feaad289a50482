/// Prior knowledge of where models may lie.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "storage/data/file_pose.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Limits on poses. Poses beyond the limits are neither searched for nor reported.
struct PoseLimits {
  /// Axis-aligned box.
  struct Region {
    Eigen::Vector3d low{0, 0, 0}, high{0, 0, 0};
    bool operator==(const Region&) const = default;
  };
  /// Largest angle between a direction of the model and one of the scene.
  struct Tilt {
    Eigen::Vector3f model_direction{0, 0, 1}, scene_direction{0, 0, 1};  ///< of any length > 0
    float max_angle_deg = 180;
    bool operator==(const Tilt&) const = default;
  };
  /// Box that contains the models' centers [file's frame and unit].
  std::optional<Region> region{};
  std::optional<Tilt> tilt{};  ///< limit on the angle between a model and a scene direction
  bool operator==(const PoseLimits&) const = default;

  /// Whether a pose with this center is within the limits. scale: factor from the given lengths to
  /// the region's unit.
  bool allow(const Pose& T_scene_model, const Eigen::Vector3f& model_center,
             double scale) const noexcept;
};

/// A pose that is expected, for example from an earlier scene.
struct ExpectedPose {
  std::string model;
  FilePose T_scene_model = FilePose::Identity();

  bool operator==(const ExpectedPose& other) const {
    return model == other.model && T_scene_model.matrix() == other.T_scene_model.matrix();
  }
};

}  // namespace trivet
