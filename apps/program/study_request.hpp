/// Runs studies, for all programs.
#pragma once

#include <string>

#include "apps/program/context.hpp"
#include "apps/study/run.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

struct StudyArguments {
  std::string config, output;
};

/// `arguments` must live as long as the command.
void add_study_arguments(CLI::App& command, StudyArguments& arguments);

/// Computes missing results, distributed by `share`, and writes tables and report.
///
/// reports  whether this process writes them
Result<void> conduct_study(const StudyArguments& arguments, const Context& context,
                           const study::Share& share, bool reports = true);

}  // namespace trivet::apps
