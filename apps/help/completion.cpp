#include "apps/help/completion.hpp"

namespace trivet::apps {

ValueKind value_kind(const OptionHelp& option) {
  if (option.type.empty() && !option.is_argument) return ValueKind::none;
  if (!option.choices.empty()) return option.is_list ? ValueKind::names : ValueKind::name;
  const bool is_file = option.is_argument || option.type == "TEXT" || option.type == "FILE" ||
                       option.type == "FOLDER";
  return is_file ? ValueKind::file : ValueKind::other;
}

std::string completion(const CommandHelp& program, const std::string& shell) {
  if (shell == "zsh") return zsh_completion(program);
  return shell == "fish" ? fish_completion(program) : bash_completion(program);
}

}  // namespace trivet::apps
