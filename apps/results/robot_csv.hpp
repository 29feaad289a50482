/// Detections as a table of poses that a robot takes.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "apps/inputs/inputs.hpp"
#include "apps/results/robot_poses.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"
#include "storage/library/library.hpp"

namespace trivet::apps {

struct RobotOptions {
  RobotConvention convention = RobotConvention::quaternion;
  std::optional<FilePose> T_robot_scene{};  ///< scenes' unit: the hand-eye calibration
  GraspFrames grasps{};                     ///< library's unit
};

/// A row for each grasp of each detection, or for the model's own frame where it has no grasps. The
/// last column names the frame: "robot", or "scene" where there is no calibration.
///
/// results  one a scene
/// Errors: cannot_create, io.
Result<void> write_robot_csv(const std::filesystem::path& file, const Library& library,
                             std::span<const SceneInput> scenes,
                             std::span<const SceneResult> results, const RobotOptions& options);

}  // namespace trivet::apps
