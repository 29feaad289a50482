/// Poses in the conventions of robot controllers.
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
#include "storage/files/json_file.hpp"

namespace trivet::apps {

/// Representation of an orientation in a controller, and the unit of its positions.
enum class RobotConvention : std::uint8_t {
  quaternion,  ///< x, y, z, w with w >= 0; [m]; used by ROS
  rpy,         ///< roll, pitch, yaw [rad] about the fixed axes x, y, z; [m]; used by URDF
  kuka,        ///< A, B, C [deg] about z, then the rotated y, then the rotated x; [mm]
  fanuc,       ///< W, P, R [deg] about the fixed axes x, y, z; [mm]
  ur,          ///< rotation vector [rad]; [m]; Universal Robots
  abb,         ///< q1, q2, q3, q4 with the scalar first, q1 >= 0; [mm]
};

/// The pose of an object for a robot: a frame of the object in the robot base frame.
struct RobotPose {
  std::array<double, 3> position{};  ///< position in the unit of the convention
  std::vector<double> orientation;   ///< 3 or 4 numbers, depending on the convention
};

/// The controller and its numbers, to choose from: "KUKA: A, B, C".
std::string_view label_of(RobotConvention convention);
/// Names of the numbers of an orientation: "A", "B", "C".
std::span<const std::string_view> orientation_names(RobotConvention convention);
/// Unit of the numbers of an orientation: "deg", "rad", or empty for a quaternion.
std::string_view orientation_unit(RobotConvention convention);
LengthUnit length_unit(RobotConvention convention);

/// Name of the frame of poses without a hand-eye calibration.
inline constexpr std::string_view kSceneFrame = "scene";

/// Converts a pose. If an angle is not determined, since the second one is ±90 degrees, the angle
/// about x is 0.
///
/// unit  of the pose's lengths
RobotPose robot_pose(const FilePose& pose, LengthUnit unit, RobotConvention convention);

/// Grasp frames of models, T_model_grasp, keyed by model and name.
using GraspFrames = std::map<std::string, std::map<std::string, FilePose>>;

/// The frames in {"MODEL": {"GRASP": four rows of four numbers}}. Throws JsonFault.
GraspFrames parse_grasp_frames(const JsonNode& node);

/// Reads a file of such frames, in the library's unit.
/// Errors: missing_input, bad_data.
Result<GraspFrames> read_grasp_frames(const std::filesystem::path& file);

/// Reads four rows of four numbers: T_robot_scene, in the scenes' unit.
/// Errors: missing_input, bad_data.
Result<FilePose> read_frame(const std::filesystem::path& file);

/// The other unit, if the length of a hand-eye calibration in this unit suggests that one: a robot
/// is hardly nearer to a scene than 10 mm, nor farther than 50 m.
std::optional<LengthUnit> likelier_frame_unit(const FilePose& T_robot_scene, LengthUnit unit);
/// A sentence that warns if likelier_frame_unit() suggests another unit.
std::optional<std::string> frame_unit_doubt(const FilePose& T_robot_scene, LengthUnit unit);

/// The other unit, if the length of the longest grasp of a model in this unit suggests that one.
/// Read in mm, such a grasp is nearer to the model's origin than a tenth of the diameter and than
/// 1 mm; read in m, it is farther than ten diameters and than 1 m.
///
/// length, diameter  in the unit
std::optional<LengthUnit> likelier_grasp_unit(double length, double diameter, LengthUnit unit);

}  // namespace trivet::apps

namespace trivet {
/// The names of the conventions.
template <>
std::span<const Choice> choices_of<apps::RobotConvention>();
}  // namespace trivet
