#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/help/completion.hpp"

namespace trivet::apps {
namespace {

std::string single_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c;
  }
  return out + "'";
}

/// A condition of fish: the words of this command are on the command line.
std::string condition(const CommandHelp& command) {
  std::string all;
  std::string_view words = command.name;
  while (words.find(' ') != std::string_view::npos) {
    words.remove_prefix(words.find(' ') + 1);
    all += fmt::format("{}__fish_seen_subcommand_from {}", all.empty() ? "" : "; and ",
                       words.substr(0, words.find(' ')));
  }
  return all;
}

std::string option_line(const OptionHelp& option, const std::string& where) {
  std::string line = "complete -c trivet";
  if (!where.empty()) line += " -n " + single_quoted(where);
  for (const std::string& name : option.names)
    line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
  switch (value_kind(option)) {
    case ValueKind::none:
      break;
    case ValueKind::name:
      line += fmt::format(" -xa '{}'", fmt::join(option.choices, " "));
      break;
    case ValueKind::names:
      line += fmt::format(" -xa '(__fish_append , {})'", fmt::join(option.choices, " "));
      break;
    case ValueKind::file:
      line += " -rF";
      break;
    case ValueKind::other:
      line += " -x";
  }
  return line + " -d " + single_quoted(first_line(option.meaning)) + '\n';
}

std::string lines_of(const CommandHelp& command) {
  const std::string where = condition(command);
  std::string out;
  bool accepts_files = false;
  for (const OptionGroupHelp& group : command.groups) {
    for (const OptionHelp& option : group.options) {
      accepts_files = accepts_files || option.is_argument;
      if (!option.is_argument) out += option_line(option, where);
    }
  }
  if (accepts_files) out += fmt::format("complete -c trivet -n '{}' -F\n", where);
  std::vector<std::string> words;
  for (const CommandHelp& below : command.commands)
    words.push_back(below.name.substr(below.name.rfind(' ') + 1));
  const std::string none = where.empty() ? "__fish_use_subcommand"
                                         : fmt::format("{}; and not __fish_seen_subcommand_from {}",
                                                       where, fmt::join(words, " "));
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += fmt::format("complete -c trivet -n '{}' -a {} -d {}\n", none, words[i],
                       single_quoted(first_line(command.commands[i].meaning)));
  }
  for (const CommandHelp& below : command.commands) out += lines_of(below);
  return out;
}

}  // namespace

std::string fish_completion(const CommandHelp& program) {
  return "# Completion of trivet for fish. Written by `trivet --completion fish`.\n"
         "complete -c trivet -f\ncomplete -c trivet -l help -s h -d 'Print the help and exit'\n" +
         lines_of(program);
}

}  // namespace trivet::apps
