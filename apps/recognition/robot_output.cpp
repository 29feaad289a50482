#include "apps/recognition/robot_output.hpp"

#include <fmt/format.h>

#include <map>
#include <span>
#include <utility>

#include "engine/libraries/edit_library.hpp"
#include "engine/options/declare_option.hpp"

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

/// Errors: of reading; usage (a grasp of a model that is not in the library).
Result<RobotOptions> robot_options(const OutputArguments& arguments, const Library& library) {
  RobotOptions options;
  engine::FieldTraits<RobotConvention>::set(options.convention, arguments.robot);
  if (!arguments.robot_frame.empty()) {
    const Result<FilePose> frame = read_frame(arguments.robot_frame);
    if (!frame) return frame.error();
    options.T_robot_scene = *frame;
  }
  if (arguments.grasps.empty()) return options;
  Result<GraspFrames> grasps = read_grasp_frames(arguments.grasps);
  if (!grasps) return grasps.error();
  options.grasps = *std::move(grasps);
  for (const auto& [model, frames] : options.grasps) {
    if (const Result<std::uint32_t> found = find_model(library, model); !found)
      return Error{ErrorCode::usage,
                   fmt::format("{}: {}", arguments.grasps, found.error().message)};
  }
  return options;
}

/// Warns of a hand-eye calibration in `file` whose length suggests another unit than the scenes'.
void warn_of_unit(const Console& console, const RobotOptions& robot, std::string_view file,
                  std::span<const SceneInput> scenes, const Library& library) {
  if (!robot.T_robot_scene) return;
  for (const SceneInput& scene : scenes) {
    const auto doubt =
        frame_unit_doubt(*robot.T_robot_scene, scene_unit(scene, library.header.unit));
    if (doubt) return console.warning(fmt::format("{}: {}", file, *doubt));
  }
}

}  // namespace

Result<std::unique_ptr<RobotOutput>> RobotOutput::open(const OutputArguments& arguments,
                                                       const RecognitionRequest& request,
                                                       const Console& console) {
  const Library& library = request.recognizer.library();
  Result<RobotOptions> options = robot_options(arguments, library);
  if (!options) return options.error();
  warn_of_unit(console, *options, arguments.robot_frame, request.scenes.sources, library);
  return std::unique_ptr<RobotOutput>(
      new RobotOutput(arguments.robot_csv, library, *std::move(options)));
}

RobotOutput::RobotOutput(std::string file, const Library& library, RobotOptions options)
    : file_(std::move(file)),
      library_(library),
      options_(std::move(options)),
      table_(table_header(options_.convention)) {}

Result<void> RobotOutput::add(const RecognizedScene& scene) {
  for (const Detection& detection : scene.reported.detections) {
    const auto grasps = options_.grasps.find(detection.model);
    if (grasps == options_.grasps.end()) {
      add_row(scene, detection, "", FilePose::Identity());
      continue;
    }
    for (const auto& [name, T_model_grasp] : grasps->second)
      add_row(scene, detection, name, T_model_grasp);
  }
  return {};
}

Result<void> RobotOutput::finish() { return table_.write(file_); }

void RobotOutput::add_row(const RecognizedScene& scene, const Detection& detection,
                          const std::string& grasp, FilePose T_model_grasp) {
  const LengthUnit unit = scene_unit(scene.input, library_.header.unit);
  T_model_grasp.translation() *= unit_scale(library_.header.unit, unit);
  const FilePose pose = options_.T_robot_scene.value_or(FilePose::Identity()) *
                        in_file_frame(detection.T_scene_model, scene.reported.offset) *
                        T_model_grasp;
  const RobotPose robot = robot_pose(pose, unit, options_.convention);
  table_.row().text(scene.input.file.string()).text(detection.model).text(grasp);
  table_.number(detection.score).number(detection.pose_score());
  table_.count(detection.alternatives.empty() ? 0 : 1);
  for (const double x : robot.position) table_.number(x);
  for (const double x : robot.orientation) table_.number(x);
  table_.text(options_.T_robot_scene ? "robot" : "scene");
}

}  // namespace trivet::apps
