#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/program/recognize_request.hpp"
#include "apps/report/recognition_report.hpp"
#include "apps/results/bop_csv.hpp"
#include "apps/results/coco_results.hpp"
#include "apps/results/detections_json.hpp"
#include "apps/results/failed_scenes.hpp"
#include "apps/results/robot_csv.hpp"
#include "apps/results/standard_output.hpp"
#include "apps/results/write_json.hpp"
#include "apps/words/explanation_words.hpp"
#include "apps/words/recognition_text.hpp"
#include "apps/words/reported_part.hpp"
#include "engine/libraries/edit_library.hpp"
#include "engine/options/declare_option.hpp"
#include "engine/recognition/estimate_camera.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps {
namespace {

/// Recognize the scenes, one after the other to `emit` or, what failed, to `fail`; with the cameras that were estimated, if
/// that is asked for.
Result<void> recognize_scenes(const Recognizer& recognizer, std::span<SceneInput> scenes,
                              const RecognizeOptions& options, bool estimate_camera,
                              const Progress& progress,
                              const std::function<void(std::size_t, const SceneResult&)>& emit,
                              const std::function<void(std::size_t, const Error&)>& fail) {
  if (!estimate_camera) return recognize_all(recognizer, scenes, options, progress, emit, fail);
  const Result<std::vector<Result<SceneResult>>> results =
      recognize_estimating_camera(recognizer, scenes, options, progress);
  if (!results) return results.error();
  for (std::size_t s = 0; s < results->size(); ++s) {
    const Result<SceneResult>& result = (*results)[s];
    result ? emit(s, *result) : fail(s, result.error());
  }
  return {};
}

/// What the command says of the robot; every grasp must be of a model of the library.
Result<RobotOptions> robot_options(const SceneCommand& arguments, const Library& library) {
  RobotOptions options;
  engine::FieldTraits<RobotConvention>::set(options.convention, arguments.robot);
  if (!arguments.robot_frame.empty()) {
    const Result<FilePose> frame = read_frame(arguments.robot_frame);
    if (!frame) return frame.error();
    options.T_robot_scene = *frame;
  }
  if (!arguments.grasps.empty()) {
    Result<GraspFrames> grasps = read_grasp_frames(arguments.grasps);
    if (!grasps) return grasps.error();
    options.grasps = *std::move(grasps);
    for (const auto& [model, frames] : options.grasps) {
      if (const Result<std::uint32_t> found = find_model(library, model); !found)
        return Error{ErrorCode::usage,
                     fmt::format("{}: {}", arguments.grasps, found.error().message)};
    }
  }
  return options;
}

/// Warn of a calibration in `file` whose length looks like that of another unit than the scenes'.
void warn_of_unit(const Console& console, const RobotOptions& robot, std::string_view file,
                  std::span<const SceneInput> scenes, const Library& library) {
  if (!robot.T_robot_scene) return;
  for (const SceneInput& scene : scenes) {
    const auto doubt =
        frame_unit_doubt(*robot.T_robot_scene, scene_unit(scene, library.header.unit));
    if (doubt) return console.warning(fmt::format("{}: {}", file, *doubt));
  }
}

Result<void> recognize(const SceneCommand& arguments, const Context& context) {
  Result<RecognitionRequest> request = make_request(arguments, context.console);
  if (!request) return request.error();
  const Recognizer& recognizer = request->recognizer;
  const Library& library = recognizer.library();
  const Result<RobotOptions> robot = robot_options(arguments, library);
  if (!robot) return robot.error();
  SceneInputs& scenes = request->scenes;
  warn_of_unit(context.console, *robot, arguments.robot_frame, scenes.sources, library);
  const RecognizeOptions &options = request->options, &kept = request->kept;

  RecognizeOptions in_json = options;
  in_json.max_rejected = 0;  // these are for people
  nlohmann::ordered_json document{{"library", arguments.library},
                                  {"calibration", calibration_json(recognizer)},
                                  {"scenes", nlohmann::ordered_json::array()},
                                  {"cameras", nlohmann::ordered_json::array()}};
  std::vector<BopResult> bop_results;
  std::vector<CocoResult> coco_results;
  Result<void> seen;              // in the depth images
  std::vector<SceneResult> told;  // for the report and the robot
  std::vector<SceneInput> told_scenes;
  std::vector<Error> failures;
  std::vector<CameraCheck> checks;
  Result<void> printed;  // what fails first, which more would not mend
  const Result<void> done = recognize_scenes(
      recognizer, scenes.sources, kept, arguments.estimate_camera,
      context.console.progress("recognized", context.stop),
      [&](std::size_t index, const SceneResult& all) {
        if (!arguments.bop_csv.empty()) add_bop_results(scenes, index, all, bop_results);
        if (!arguments.coco.empty() && seen)
          seen = add_coco_results(scenes, index, recognizer, all, coco_results);
        const SceneResult result = reported_part(all, kept);
        const SceneInput& scene = scenes.sources[index];
        if (!arguments.json.empty()) {
          document["scenes"].push_back(
              scene_json(scene.file.string(), result, recognizer.score(), in_json));
        } else if (printed) {
          printed = write_output(scene_text(scene, result, library, options.min_score) +
                                 explanation_text(result, recognizer.score(), options));
        }
        if (!arguments.report.empty() || !arguments.robot_csv.empty()) {
          told.push_back(result);
          told_scenes.push_back(scene);
        }
        if (result.stats.camera_check) checks.push_back(*result.stats.camera_check);
      },
      [&](std::size_t index, const Error& error) {
        failures.push_back(error);
        document["scenes"].push_back(failed_scene_json(scenes.sources[index].file.string(), error));
      });
  if (!done) return done;
  if (!seen) return seen;
  for (const CameraCheck& check : join_checks(checks)) {
    document["cameras"].push_back(camera_check_json(check));
    if (arguments.json.empty() && printed) printed = write_output(camera_text(check));
  }
  if (!printed) return printed;
  if (!arguments.bop_csv.empty()) {
    const Result<void> written = write_bop_results(arguments.bop_csv, bop_results);
    if (!written) return written;
  }
  if (!arguments.coco.empty()) {
    const Result<void> written = write_coco_results(arguments.coco, coco_results);
    if (!written) return written;
  }
  if (!arguments.robot_csv.empty()) {
    const Result<void> written =
        write_robot_csv(arguments.robot_csv, library, told_scenes, told, *robot);
    if (!written) return written;
  }
  if (!arguments.json.empty()) {
    const Result<void> written = write_json(arguments.json, document);
    if (!written) return written;
  }
  if (!arguments.report.empty()) {
    const Result<void> drawn = write_recognition_report(
        arguments.report, {recognizer, options, told_scenes, told, context.command},
        context.console.progress("drawn", context.stop));
    if (!drawn) return drawn;
    context.console.wrote_report(arguments.report);
  }
  return failed_scenes(failures, scenes.sources.size());
}

}  // namespace

void add_recognize(CLI::App& app, Context& context) {
  auto arguments = std::make_shared<SceneCommand>();
  CLI::App* command = app.add_subcommand("recognize", "Find the models of a library in scenes");
  add_scene_command(*command, *arguments);
  command->callback([arguments, &context] {
    context.run = [arguments, &context] { return recognize(*arguments, context); };
  });
}

}  // namespace trivet::apps
