/// The command line as data.
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// Everything that `app` and the commands below it say of themselves.
///
/// name  of `app` in what is written of it
CommandHelp describe_command(CLI::App& app, const std::string& name);

}  // namespace trivet::apps
