/// Manual pages, in the macros of man(7).
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace trivet::apps {

/// The page, in section 1, of a command with its subcommands, or of the program.
///
/// name  one of the program's commands, such as "recognize", or no command: the program
std::string man_page(const CommandHelp& program, const std::string& name);

}  // namespace trivet::apps
