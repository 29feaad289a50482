#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/help/completion.hpp"

namespace trivet::apps {
namespace {

/// The words after the program's name, such as "library info".
std::string words_of(const CommandHelp& command) {
  const std::size_t space = command.name.find(' ');
  return space == std::string::npos ? "" : command.name.substr(space + 1);
}

/// Lines of the script, each group for a separate `case`.
struct BashCases {
  std::string steps;    ///< transitions from a command to a subcommand
  std::string values;   ///< values of an option of a command
  std::string offered;  ///< commands and options
};

std::string value_action(const OptionHelp& option) {
  switch (value_kind(option)) {
    case ValueKind::name:
      return fmt::format("words=\"{}\"", fmt::join(option.choices, " "));
    case ValueKind::names:
      return fmt::format("words=\"{}\" list=yes", fmt::join(option.choices, " "));
    case ValueKind::file:
      return "files=yes";
    default:
      return "return";
  }
}

/// everywhere  options of every command
void add_cases(const CommandHelp& command, const std::vector<OptionHelp>& everywhere,
               BashCases& cases) {
  const std::string words = words_of(command);
  std::vector<std::string> names{"--help"}, below;
  const auto add = [&](const OptionHelp& option) {
    if (option.is_argument) return;
    names.insert(names.end(), option.names.begin(), option.names.end());
    if (value_kind(option) == ValueKind::none) return;
    std::string pattern;
    for (const std::string& name : option.names)
      pattern += fmt::format("{}\"{} {}\"", pattern.empty() ? "" : " | ", words, name);
    cases.values += fmt::format("    {}) {} ;;\n", pattern, value_action(option));
  };
  for (const OptionGroupHelp& group : command.groups) {
    for (const OptionHelp& option : group.options) add(option);
  }
  if (!words.empty()) {
    for (const OptionHelp& option : everywhere) add(option);
  }
  for (const CommandHelp& one : command.commands) {
    const std::string word = one.name.substr(one.name.rfind(' ') + 1);
    below.push_back(word);
    cases.steps += fmt::format("      \"{} {}\") command=\"{}\" ;;\n", words, word, words_of(one));
  }
  cases.offered += fmt::format("    \"{}\") commands=\"{}\" options=\"{}\" ;;\n", words,
                               fmt::join(below, " "), fmt::join(names, " "));
  for (const CommandHelp& one : command.commands) add_cases(one, everywhere, cases);
}

}  // namespace

std::string bash_completion(const CommandHelp& program) {
  BashCases cases;
  add_cases(program, common_options(program), cases);
  return fmt::format(R"(# Completion of trivet for bash. Written by `trivet --completion bash`.
_trivet() {{
  local cur="${{COMP_WORDS[COMP_CWORD]}}" before="${{COMP_WORDS[COMP_CWORD - 1]}}"
  local command="" commands="" options="" words="" list="" files="" word
  COMPREPLY=()
  if [[ $cur == "=" ]]; then
    cur=""
  elif [[ $before == "=" ]]; then
    before="${{COMP_WORDS[COMP_CWORD - 2]}}"
  fi
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case "$command $word" in
{}    esac
  done
  case "$command" in
{}  esac
  case "$command $before" in
{}    *)
      if [[ $cur == -* ]]; then
        words=$options
      elif [[ -n $commands ]]; then
        words=$commands
      else
        files=yes
      fi
      ;;
  esac
  if [[ -n $list ]]; then
    local chosen=""
    [[ $cur == *,* ]] && chosen="${{cur%,*}},"
    mapfile -t COMPREPLY < <(compgen -P "$chosen" -W "$words" -- "${{cur##*,}}")
  elif [[ -n $files ]]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$cur")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$cur")
  fi
}}
complete -F _trivet trivet
)",
                     cases.steps, cases.offered, cases.values);
}

}  // namespace trivet::apps
