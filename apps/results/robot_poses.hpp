/// Poses as controllers of robots take them.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/options/option.hpp"
#include "storage/common/result.hpp"
#include "storage/data/file_pose.hpp"
#include "storage/data/length_unit.hpp"

namespace trivet::apps {

/// How a controller writes an orientation, and the unit of its positions.
enum class RobotConvention : std::uint8_t {
  quaternion,  ///< x, y, z, w with w >= 0; [m], as ROS
  rpy,         ///< roll, pitch, yaw [rad] about the fixed axes x, y, z; [m], as URDF
  kuka,        ///< A, B, C [deg] about z, then the turned y, then the turned x; [mm]
  fanuc,       ///< W, P, R [deg] about the fixed axes x, y, z; [mm]
  ur,          ///< rotation vector [rad]; [m], as Universal Robots
  abb,         ///< q1, q2, q3, q4 with the scalar first, q1 >= 0; [mm]
};

/// What a robot is told of an object: a frame of it in the frame that the robot moves in.
struct RobotPose {
  std::array<double, 3> position{};  ///< in the convention's unit
  std::vector<double> orientation;   ///< 3 or 4 numbers, as the convention has them
};

/// Names of the numbers of an orientation: "A", "B", "C".
std::span<const std::string_view> orientation_names(RobotConvention convention);
LengthUnit length_unit(RobotConvention convention);

/// Where an angle is not determined, since the second one turns by 90 degrees, the one about x is 0.
/// unit  of the pose's lengths
RobotPose robot_pose(const FilePose& pose, LengthUnit unit, RobotConvention convention);

/// Frames of models that robots grasp by, T_model_grasp, by model and name.
using GraspFrames = std::map<std::string, std::map<std::string, FilePose>>;

/// {"MODEL": {"GRASP": four rows of four numbers}}, in the library's unit. Errors: missing_input,
/// bad_data.
Result<GraspFrames> read_grasp_frames(const std::filesystem::path& file);

/// Four rows of four numbers: T_robot_scene, in the scenes' unit. Errors: missing_input, bad_data.
Result<FilePose> read_frame(const std::filesystem::path& file);

/// Whether the length of a calibration looks like that of another unit, as a sentence: a robot is
/// hardly nearer to what it sees than 10 mm, nor farther than 50 m.
std::optional<std::string> frame_unit_doubt(const FilePose& T_robot_scene, LengthUnit unit);

}  // namespace trivet::apps

namespace trivet {
/// The names of the conventions.
template <>
std::span<const Choice> choices_of<apps::RobotConvention>();
}  // namespace trivet
