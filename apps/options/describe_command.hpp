/// The command line as data.
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// The descriptions of `app` and of all its subcommands.
///
/// name  of `app` in the description
CommandHelp describe_command(CLI::App& app, const std::string& name);

}  // namespace trivet::apps
