#include "apps/results/robot_poses.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace trivet {

template <>
std::span<const Choice> choices_of<apps::RobotConvention>() {
  static constexpr Choice kChoices[] = {
      {"quaternion", "x, y, z, w in m, as ROS has them"},
      {"rpy", "roll, pitch, yaw about the fixed axes x, y, z in rad, and m, as URDF"},
      {"kuka", "A, B, C about z, y', x'' in degrees, and mm"},
      {"fanuc", "W, P, R about the fixed axes x, y, z in degrees, and mm"},
      {"ur", "the rotation vector of Universal Robots in rad, and m"},
      {"abb", "q1, q2, q3, q4, the scalar first, and mm"}};
  return kChoices;
}

}  // namespace trivet

namespace trivet::apps {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;
// Sine of a second angle that leaves the other two undetermined.
constexpr double kUpright = 1 - 1e-12;
// Lengths of plausible calibrations.
constexpr double kShortestInMm = 10, kLongestInM = 50;
// Distances of plausible grasps from the origin of their model, also as shares of its diameter.
constexpr double kNearestInMm = 1, kNearestShare = 0.1, kFarthestInM = 1, kFarthestShare = 10;

/// What is written beside the numbers of a convention.
struct Notation {
  std::string_view label;
  std::span<const std::string_view> names;
  std::string_view orientation_unit;
  LengthUnit length_unit;
};

const Notation& notation_of(RobotConvention convention) {
  static constexpr std::string_view kQuaternion[] = {"qx", "qy", "qz", "qw"},
                                    kRpy[] = {"roll", "pitch", "yaw"}, kKuka[] = {"A", "B", "C"},
                                    kFanuc[] = {"W", "P", "R"}, kUr[] = {"rx", "ry", "rz"},
                                    kAbb[] = {"q1", "q2", "q3", "q4"};
  constexpr LengthUnit kMeter = LengthUnit::meter, kMillimeter = LengthUnit::millimeter;
  // In the order of the enumeration.
  static constexpr Notation kNotations[] = {
      {"ROS: quaternion", kQuaternion, "", kMeter},
      {"URDF: roll, pitch, yaw", kRpy, "rad", kMeter},
      {"KUKA: A, B, C", kKuka, "deg", kMillimeter},
      {"Fanuc: W, P, R", kFanuc, "deg", kMillimeter},
      {"Universal Robots: rotation vector", kUr, "rad", kMeter},
      {"ABB: quaternion, scalar first", kAbb, "", kMillimeter}};
  return kNotations[static_cast<std::size_t>(convention)];
}

/// Angles about the fixed axes x, y, z, in this order.
Eigen::Vector3d fixed_angles(const Eigen::Matrix3d& r) {
  const double sine = -r(2, 0);
  if (std::abs(sine) > kUpright) {
    return {0, std::copysign(std::numbers::pi / 2, sine), std::atan2(-r(0, 1), r(1, 1))};
  }
  return {std::atan2(r(2, 1), r(2, 2)), std::asin(sine), std::atan2(r(1, 0), r(0, 0))};
}

Eigen::Quaterniond quaternion_of(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() *= -1;
  return q;
}

}  // namespace

std::string_view label_of(RobotConvention convention) { return notation_of(convention).label; }

std::span<const std::string_view> orientation_names(RobotConvention convention) {
  return notation_of(convention).names;
}

std::string_view orientation_unit(RobotConvention convention) {
  return notation_of(convention).orientation_unit;
}

LengthUnit length_unit(RobotConvention convention) { return notation_of(convention).length_unit; }

RobotPose robot_pose(const FilePose& pose, LengthUnit unit, RobotConvention convention) {
  RobotPose out;
  const Eigen::Vector3d position = unit_scale(unit, length_unit(convention)) * pose.translation();
  out.position = {position.x(), position.y(), position.z()};
  // Poses have single precision: use the nearest rotation in double precision.
  const Eigen::Quaterniond q = quaternion_of(pose.linear());
  const Eigen::Matrix3d rotation = q.toRotationMatrix();
  const Eigen::Vector3d angles = fixed_angles(rotation);
  switch (convention) {
    case RobotConvention::quaternion:
      out.orientation = {q.x(), q.y(), q.z(), q.w()};
      break;
    case RobotConvention::rpy:
      out.orientation = {angles.x(), angles.y(), angles.z()};
      break;
    case RobotConvention::kuka:
      for (const double angle : {angles.z(), angles.y(), angles.x()})
        out.orientation.push_back(kDegreesPerRadian * angle);
      break;
    case RobotConvention::fanuc:
      for (const double angle : angles) out.orientation.push_back(kDegreesPerRadian * angle);
      break;
    case RobotConvention::ur: {
      const Eigen::AngleAxisd turn(q);
      const Eigen::Vector3d vector = turn.angle() * turn.axis();
      out.orientation = {vector.x(), vector.y(), vector.z()};
      break;
    }
    case RobotConvention::abb:
      out.orientation = {q.w(), q.x(), q.y(), q.z()};
      break;
  }
  // A sum with zero has no negative zero.
  for (double& x : out.position) x += 0.0;
  for (double& x : out.orientation) x += 0.0;
  return out;
}

GraspFrames parse_grasp_frames(const JsonNode& node) {
  GraspFrames frames;
  for (const auto& [model, grasps] : node.object().members()) {
    for (const auto& [name, pose] : grasps.object().members())
      frames[model][name] = pose.file_pose();
  }
  return frames;
}

Result<GraspFrames> read_grasp_frames(const std::filesystem::path& file) {
  GraspFrames frames;
  const Result<void> done =
      with_json(file, [&](const JsonNode& root) { frames = parse_grasp_frames(root); });
  if (!done) return done.error();
  return frames;
}

Result<FilePose> read_frame(const std::filesystem::path& file) {
  FilePose frame;
  const Result<void> done =
      with_json(file, [&](const JsonNode& root) { frame = root.file_pose(); });
  if (!done) return done.error();
  return frame;
}

std::optional<LengthUnit> likelier_frame_unit(const FilePose& T_robot_scene, LengthUnit unit) {
  const double length = T_robot_scene.translation().norm();
  if (unit == LengthUnit::millimeter && length > 0 && length < kShortestInMm)
    return LengthUnit::meter;
  if (unit == LengthUnit::meter && length > kLongestInM) return LengthUnit::millimeter;
  return std::nullopt;
}

std::optional<std::string> frame_unit_doubt(const FilePose& T_robot_scene, LengthUnit unit) {
  const std::optional<LengthUnit> likelier = likelier_frame_unit(T_robot_scene, unit);
  if (!likelier) return std::nullopt;
  return fmt::format("it moves by {:.4g} {}, the unit of the scenes: is it in {}?",
                     T_robot_scene.translation().norm(), unit_name(unit), unit_name(*likelier));
}

std::optional<LengthUnit> likelier_grasp_unit(double length, double diameter, LengthUnit unit) {
  const bool is_near = length > 0 && length < std::min(kNearestInMm, kNearestShare * diameter);
  const bool is_far = length > std::max(kFarthestInM, kFarthestShare * diameter);
  if (unit == LengthUnit::millimeter && is_near) return LengthUnit::meter;
  if (unit == LengthUnit::meter && is_far) return LengthUnit::millimeter;
  return std::nullopt;
}

}  // namespace trivet::apps
