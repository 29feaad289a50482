/// Registry of the outputs of a command and their options. A new kind of output is a file in this
/// folder, and is registered here.
#pragma once

#include <string>

#include "apps/program/context.hpp"
#include "apps/recognition/output_list.hpp"
#include "storage/common/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

struct RecognitionRequest;

/// Files and folders to write. An empty name means no such output.
struct OutputArguments {
  std::string json, report, bop_csv, coco;
  std::string robot_csv, robot, robot_frame, grasps;
};

/// `arguments` must live as long as the command.
void add_output_options(CLI::App& command, OutputArguments& arguments);

/// Makes every requested output, and text output unless JSON is requested.
///
/// library           as named on the command line
/// request, context  outlive the outputs
/// Errors: of RobotOutput::open.
Result<OutputList> make_outputs(const OutputArguments& arguments, const std::string& library,
                                const RecognitionRequest& request, const Context& context);

}  // namespace trivet::apps
