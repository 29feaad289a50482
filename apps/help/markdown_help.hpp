/// The help of all commands as one page: docs/cli.md.
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace trivet::apps {

/// A command with its options and all its subcommands, in Markdown.
std::string markdown_help(const CommandHelp& command);

}  // namespace trivet::apps
