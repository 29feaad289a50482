/// Which outputs a command has, and what its command line says of them. A new kind of output is a
/// file beside this one, and is registered here.
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

/// Files and folders to write. An empty name asks for nothing.
struct OutputArguments {
  std::string json, report, bop_csv, coco;
  std::string robot_csv, robot, robot_frame, grasps;
};

/// `arguments` must live as long as the command.
void add_output_options(CLI::App& command, OutputArguments& arguments);

/// Make every output that the arguments ask for, and lines for a person unless they ask for JSON.
///
/// library           as the command line names it
/// request, context  outlive the outputs
/// Errors: of RobotOutput::open.
Result<OutputList> make_outputs(const OutputArguments& arguments, const std::string& library,
                                const RecognitionRequest& request, const Context& context);

}  // namespace trivet::apps
