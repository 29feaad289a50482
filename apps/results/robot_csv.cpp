#include "apps/results/robot_csv.hpp"

#include <fmt/format.h>

#include <string>

#include "apps/results/csv_table.hpp"

namespace trivet::apps {
namespace {

std::string header(RobotConvention convention) {
  std::string text = "scene,model,grasp,score,pose_score,ambiguous";
  for (const char axis : {'x', 'y', 'z'})
    text += fmt::format(",{} [{}]", axis, unit_name(length_unit(convention)));
  for (const std::string_view name : orientation_names(convention))
    text += fmt::format(",{}", name);
  return text + ",frame";
}

}  // namespace

Result<void> write_robot_csv(const std::filesystem::path& file, const Library& library,
                             std::span<const SceneInput> scenes,
                             std::span<const SceneResult> results, const RobotOptions& options) {
  const std::map<std::string, FilePose> whole{{"", FilePose::Identity()}};
  CsvTable table(header(options.convention));
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    const LengthUnit unit = scene_unit(scenes[s], library.header.unit);
    const double to_scene = unit_scale(library.header.unit, unit);
    for (const Detection& detection : results[s].detections) {
      const auto grasps = options.grasps.find(detection.model);
      for (auto [name, T_model_grasp] : grasps == options.grasps.end() ? whole : grasps->second) {
        T_model_grasp.translation() *= to_scene;
        const FilePose pose = options.T_robot_scene.value_or(FilePose::Identity()) *
                              in_file_frame(detection.T_scene_model, results[s].offset) *
                              T_model_grasp;
        const RobotPose told = robot_pose(pose, unit, options.convention);
        table.row().text(scenes[s].file.string()).text(detection.model).text(name);
        table.number(detection.score).number(detection.pose_score());
        table.count(detection.alternatives.empty() ? 0 : 1);
        for (const double x : told.position) table.number(x);
        for (const double x : told.orientation) table.number(x);
        table.text(options.T_robot_scene ? "robot" : "scene");
      }
    }
  }
  return table.write(file);
}

}  // namespace trivet::apps
