/// Completion scripts for shells.
#pragma once

#include <string>

#include "apps/help/command_help.hpp"

namespace trivet::apps {

/// What a shell offers as a value.
enum class ValueKind {
  none,   ///< a flag has no value
  name,   ///< one of the choices
  names,  ///< some of the choices, separated by commas
  file,   ///< files and folders
  other,  ///< nothing: numbers and the like
};
ValueKind value_kind(const OptionHelp& option);

/// A script that completes commands, options, values of options, and file names.
///
/// shell  "bash", "zsh" or "fish"
std::string completion(const CommandHelp& program, const std::string& shell);

std::string bash_completion(const CommandHelp& program);
std::string zsh_completion(const CommandHelp& program);
std::string fish_completion(const CommandHelp& program);

}  // namespace trivet::apps
