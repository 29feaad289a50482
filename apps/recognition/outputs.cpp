#include "apps/recognition/outputs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/options/add_options.hpp"
#include "apps/recognition/bop_output.hpp"
#include "apps/recognition/coco_output.hpp"
#include "apps/recognition/json_output.hpp"
#include "apps/recognition/report_output.hpp"
#include "apps/recognition/robot_output.hpp"
#include "apps/recognition/text_output.hpp"

namespace trivet::apps {
namespace {

void add_robot_options(CLI::App& command, OutputArguments& arguments) {
  CLI::Option* const table =
      command
          .add_option("--robot-csv", arguments.robot_csv,
                      "Write the poses found to this file as a table that a robot's program takes")
          ->type_name("FILE");
  std::vector<std::string_view> conventions;
  for (const Choice& choice : choices_of<RobotConvention>()) conventions.push_back(choice.name);
  limit_to(command.add_option("--robot", arguments.robot,
                              fmt::format("How its controller writes poses: {}; default: {}",
                                          fmt::join(conventions, ", "), conventions.front())),
           {conventions.begin(), conventions.end()})
      ->type_name("NAME")
      ->needs(table);
  command
      .add_option("--robot-frame", arguments.robot_frame,
                  "Pose of the scene's frame in the robot's, of a hand-eye calibration, in the "
                  "scene's unit: JSON, four rows of four numbers")
      ->type_name("FILE")
      ->needs(table);
  command
      .add_option("--grasps", arguments.grasps,
                  "Frames of models to grasp by, in the library's unit: JSON, "
                  "{\"MODEL\": {\"GRASP\": four rows of four numbers}}")
      ->type_name("FILE")
      ->needs(table);
}

}  // namespace

void add_output_options(CLI::App& command, OutputArguments& arguments) {
  command
      .add_option("--json", arguments.json,
                  "Write the result as JSON to this file, - for standard output")
      ->type_name("FILE");
  command
      .add_option("--report", arguments.report,
                  "Write index.html with pictures of what was found, and of what was rejected "
                  "and why, into this folder")
      ->type_name("FOLDER");
  command
      .add_option("--bop-csv", arguments.bop_csv,
                  "Write the poses found in BOP data sets to this file, as BOP expects them: also "
                  "those that are too low to be reported, down to a score of 0.1")
      ->type_name("FILE");
  command
      .add_option(
          "--coco", arguments.coco,
          "Write masks and boxes of the same poses to this file (JSON), as BOP expects them "
          "for detection and segmentation in images")
      ->type_name("FILE");
  add_robot_options(command, arguments);
}

Result<OutputList> make_outputs(const OutputArguments& arguments, const std::string& library,
                                const RecognitionRequest& request, const Context& context) {
  OutputList outputs;
  if (arguments.json.empty()) outputs.push_back(std::make_unique<TextOutput>(request));
  if (!arguments.bop_csv.empty())
    outputs.push_back(std::make_unique<BopOutput>(arguments.bop_csv, request));
  if (!arguments.coco.empty())
    outputs.push_back(std::make_unique<CocoOutput>(arguments.coco, request));
  if (!arguments.robot_csv.empty()) {
    auto robot = RobotOutput::open(arguments, request, context.console);
    if (!robot) return robot.error();
    outputs.push_back(*std::move(robot));
  }
  if (!arguments.json.empty())
    outputs.push_back(std::make_unique<JsonOutput>(arguments.json, library, request));
  if (!arguments.report.empty())
    outputs.push_back(std::make_unique<ReportOutput>(arguments.report, request, context));
  return outputs;
}

}  // namespace trivet::apps
