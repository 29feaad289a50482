#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "apps/help/completion.hpp"

namespace trivet::apps {
namespace {

/// Text between single quotes, in which zsh's separators are escaped.
std::string quoted(std::string_view text, std::string_view separators) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      if (separators.find(c) != std::string_view::npos || c == '\\') out += '\\';
      out += c;
    }
  }
  return out;
}

std::string value_spec(const OptionHelp& option) {
  const std::string what = quoted(option.is_argument ? option.names.front() : option.type, ":");
  switch (value_kind(option)) {
    case ValueKind::none:
      return "";
    case ValueKind::name:
      return fmt::format(":{}:({})", what, fmt::join(option.choices, " "));
    case ValueKind::names:
      return fmt::format(":{}:_values -s , {} {}", what, what, fmt::join(option.choices, " "));
    case ValueKind::file:
      return fmt::format(":{}:_files", what);
    case ValueKind::other:
      return fmt::format(":{}: ", what);
  }
  return "";
}

/// Arguments of _arguments: a line for each name.
std::string specs(const OptionHelp& option) {
  if (option.is_argument)
    return fmt::format("        '{}{}'", option.is_repeated ? "*" : "", value_spec(option));
  std::string out;
  for (const std::string& name : option.names) {
    const bool has_value = value_kind(option) != ValueKind::none;
    out += fmt::format("{}        '({}){}{}[{}]{}'", out.empty() ? "" : " \\\n",
                       fmt::join(option.names, " "), name,
                       has_value ? (name.starts_with("--") ? "=" : "+") : "",
                       quoted(first_line(option.meaning), "[]:"), value_spec(option));
  }
  return out;
}

std::string function_name(const CommandHelp& command) {
  std::string name = "_" + command.name;
  std::ranges::replace(name, ' ', '_');
  std::ranges::replace(name, '-', '_');
  return name;
}

std::string function_of(const CommandHelp& command, const std::vector<OptionHelp>& everywhere) {
  std::string options = "        '(- *)--help[Print the help and exit]'";
  const auto add = [&](const OptionHelp& option) { options += " \\\n" + specs(option); };
  for (const OptionGroupHelp& group : command.groups) {
    for (const OptionHelp& option : group.options) add(option);
  }
  if (command.name.find(' ') != std::string::npos) {
    for (const OptionHelp& option : everywhere) add(option);
  }
  if (command.commands.empty()) {
    return fmt::format("{}() {{\n    _arguments -s \\\n{}\n}}\n\n", function_name(command),
                       options);
  }
  std::string names, cases, below;
  for (const CommandHelp& one : command.commands) {
    const std::string word = one.name.substr(one.name.rfind(' ') + 1);
    names += fmt::format("            '{}:{}'\n", word, quoted(first_line(one.meaning), ":"));
    cases += fmt::format("            {}) {} ;;\n", word, function_name(one));
    below += function_of(one, everywhere);
  }
  return below + fmt::format(R"({}() {{
    local context state state_descr line
    typeset -A opt_args
    _arguments -s -C \
{} \
        '1:command:->command' \
        '*::argument:->argument'
    case $state in
    command)
        local -a commands=(
{}        )
        _describe command commands
        ;;
    argument)
        case $line[1] in
{}        esac
        ;;
    esac
}}

)",
                             function_name(command), options, names, cases);
}

}  // namespace

std::string zsh_completion(const CommandHelp& program) {
  return "#compdef trivet\n# Completion of trivet for zsh. Written by `trivet --completion "
         "zsh`.\n\n" +
         function_of(program, common_options(program)) +
         "if [ \"$funcstack[1]\" = _trivet ]; then\n    _trivet \"$@\"\nelse\n    compdef _trivet "
         "trivet\nfi\n";
}

}  // namespace trivet::apps
