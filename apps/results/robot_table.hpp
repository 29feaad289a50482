/// Detections as poses for a robot controller: as numbers, and as a table.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/results/csv_table.hpp"
#include "apps/results/robot_poses.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet::apps {

/// The robot for which poses are given.
struct RobotSetup {
  RobotConvention convention = RobotConvention::quaternion;
  std::optional<FilePose> T_robot_scene{};  ///< hand-eye calibration, in the scenes' unit
  std::string robot_frame = "robot";        ///< name of the calibration's frame
  GraspFrames grasps{};                     ///< in the library's unit

  /// Name of the frame of the poses: "scene" without a hand-eye calibration.
  const std::string& frame_name() const;
};

/// A detection in a scene.
struct PosedModel {
  std::string scene, model;
  float score = 0, pose_score = 0;
  bool ambiguous = false;
  FilePose T_scene_model = FilePose::Identity();
  LengthUnit unit = LengthUnit::meter;  ///< unit of the scene
};

/// A grasp of a detection; the name is empty for the model's own frame.
struct RobotGrasp {
  std::string name;
  RobotPose pose;
};

/// The poses of a detection for the robot, one per grasp of its model, or that of the model's frame
/// if it has no grasps.
///
/// library  unit of the grasps
std::vector<RobotGrasp> robot_grasps(const RobotSetup& setup, const PosedModel& posed,
                                     LengthUnit library);

/// A table with one row per pose of robot_grasps(). The last column names the frame.
class RobotTable {
 public:
  RobotTable(RobotSetup setup, LengthUnit library);

  void add(const PosedModel& posed);
  const CsvTable& csv() const { return csv_; }

 private:
  const RobotSetup setup_;
  const LengthUnit library_;
  CsvTable csv_;
};

}  // namespace trivet::apps
