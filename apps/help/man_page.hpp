/// Manual pages, in the macros of man(7).
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace trivet::apps {

/// The page of a command with those below it, or of the program, for section 1.
///
/// name  of one of the program's commands, as "recognize", or of none: the program
std::string man_page(const CommandHelp& program, const std::string& name);

}  // namespace trivet::apps
