/// Scripts by which shells complete a command line.
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace trivet::apps {

/// What a shell offers in the place of a value.
enum class ValueKind {
  none,   ///< a flag has no value
  name,   ///< one of the choices
  names,  ///< some of the choices, separated by commas
  file,   ///< files and folders
  other,  ///< nothing: numbers and the like
};
ValueKind value_kind(const OptionHelp& option);

/// Commands, options, the values that an option may have, and names of files.
///
/// shell  "bash", "zsh" or "fish"
std::string completion(const CommandHelp& program, const std::string& shell);

std::string bash_completion(const CommandHelp& program);
std::string zsh_completion(const CommandHelp& program);
std::string fish_completion(const CommandHelp& program);

}  // namespace trivet::apps
