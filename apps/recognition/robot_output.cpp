#include "apps/recognition/robot_output.hpp"

#include <fmt/format.h>

#include <map>
#include <span>
#include <utility>

#include "engine/libraries/edit_library.hpp"
#include "engine/options/declare_option.hpp"

namespace trivet::apps {
namespace {

/// Errors: of reading; usage (a grasp of a model that is not in the library).
Result<RobotSetup> robot_setup(const OutputArguments& arguments, const Library& library) {
  RobotSetup setup;
  engine::FieldTraits<RobotConvention>::set(setup.convention, arguments.robot);
  if (!arguments.robot_frame.empty()) {
    const Result<FilePose> frame = read_frame(arguments.robot_frame);
    if (!frame) return frame.error();
    setup.T_robot_scene = *frame;
  }
  if (arguments.grasps.empty()) return setup;
  Result<GraspFrames> grasps = read_grasp_frames(arguments.grasps);
  if (!grasps) return grasps.error();
  setup.grasps = *std::move(grasps);
  for (const auto& [model, frames] : setup.grasps) {
    if (const Result<std::uint32_t> found = find_model(library, model); !found)
      return Error{ErrorCode::usage,
                   fmt::format("{}: {}", arguments.grasps, found.error().message)};
  }
  return setup;
}

/// Warns of a hand-eye calibration in `file` whose length suggests another unit than the scenes'.
void warn_of_unit(const Console& console, const RobotSetup& robot, std::string_view file,
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
  Result<RobotSetup> setup = robot_setup(arguments, library);
  if (!setup) return setup.error();
  warn_of_unit(console, *setup, arguments.robot_frame, request.scenes.sources, library);
  return std::unique_ptr<RobotOutput>(
      new RobotOutput(arguments.robot_csv, library, *std::move(setup)));
}

RobotOutput::RobotOutput(std::string file, const Library& library, RobotSetup setup)
    : file_(std::move(file)), library_(library), table_(std::move(setup), library.header.unit) {}

Result<void> RobotOutput::add(const RecognizedScene& scene) {
  for (const Detection& detection : scene.reported.detections) {
    table_.add({scene.input.file.string(), detection.model, detection.score, detection.pose_score(),
                detection.is_ambiguous(),
                in_file_frame(detection.T_scene_model, scene.reported.offset),
                scene_unit(scene.input, library_.header.unit)});
  }
  return {};
}

Result<void> RobotOutput::finish() { return table_.csv().write(file_); }

}  // namespace trivet::apps
