#include "apps/results/robot_table.hpp"

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace trivet::apps {
namespace {

std::string table_header(RobotConvention convention) {
  std::string text = "scene,model,grasp,score,pose_score,ambiguous";
  for (const char axis : {'x', 'y', 'z'})
    text += fmt::format(",{} [{}]", axis, unit_name(length_unit(convention)));
  for (const std::string_view name : orientation_names(convention))
    text += fmt::format(",{}", name);
  return text + ",frame";
}

}  // namespace

const std::string& RobotSetup::frame_name() const {
  static const std::string scene(kSceneFrame);
  return T_robot_scene ? robot_frame : scene;
}

std::vector<RobotGrasp> robot_grasps(const RobotSetup& setup, const PosedModel& posed,
                                     LengthUnit library) {
  const FilePose pose = setup.T_robot_scene.value_or(FilePose::Identity()) * posed.T_scene_model;
  const auto grasps = setup.grasps.find(posed.model);
  if (grasps == setup.grasps.end() || grasps->second.empty())
    return {{"", robot_pose(pose, posed.unit, setup.convention)}};
  std::vector<RobotGrasp> out;
  for (const auto& [name, frame] : grasps->second) {
    FilePose T_model_grasp = frame;
    T_model_grasp.translation() *= unit_scale(library, posed.unit);
    out.push_back({name, robot_pose(pose * T_model_grasp, posed.unit, setup.convention)});
  }
  return out;
}

RobotTable::RobotTable(RobotSetup setup, LengthUnit library)
    : setup_(std::move(setup)), library_(library), csv_(table_header(setup_.convention)) {}

void RobotTable::add(const PosedModel& posed) {
  for (const RobotGrasp& grasp : robot_grasps(setup_, posed, library_)) {
    csv_.row().text(posed.scene).text(posed.model).text(grasp.name);
    csv_.number(posed.score).number(posed.pose_score).count(posed.ambiguous ? 1 : 0);
    for (const double x : grasp.pose.position) csv_.number(x);
    for (const double x : grasp.pose.orientation) csv_.number(x);
    csv_.text(setup_.frame_name());
  }
}

}  // namespace trivet::apps
