#include "apps/help/markdown_help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <string_view>

namespace trivet::apps {
namespace {

/// The content of a table cell.
std::string cell(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\n') {
      out += "<br>";
    } else if (c == '|' || c == '<') {
      out += fmt::format("\\{}", c);
    } else {
      out += c;
    }
  }
  return out;
}

std::string row(const OptionHelp& option) {
  return fmt::format("| `{}{}{}` | {} | {}{} |\n", fmt::join(option.names, ","),
                     option.type.empty() ? "" : " ", option.type,
                     option.usual.empty() ? "" : "`" + option.usual + "`",
                     option.is_required ? "Required. " : "", cell(option.meaning));
}

/// known  tables, with the command below which each is printed
std::string command_text(const CommandHelp& command, std::map<std::string, std::string>& known) {
  std::string out = fmt::format("\n## {}\n\n{}\n", command.name, command.meaning);
  for (const OptionGroupHelp& group : command.groups) {
    std::string rows;
    for (const OptionHelp& option : group.options) rows += row(option);
    const auto [first, is_new] = known.emplace(rows, command.name);
    out += is_new ? fmt::format("\n**{}**\n\n| option | default | meaning |\n|---|---|---|\n{}",
                                group.title, rows)
                  : fmt::format("\n**{}**: as of `{}`.\n", group.title, first->second);
  }
  for (const CommandHelp& below : command.commands) out += command_text(below, known);
  return out;
}

}  // namespace

std::string markdown_help(const CommandHelp& command) {
  std::map<std::string, std::string> known;
  return "# Command line\n\nWritten by `trivet --help-markdown > docs/cli.md`. Every command has "
         "`--help`; `trivet --man COMMAND` prints its manual, `trivet --completion SHELL` what "
         "lets bash, zsh "
         "or fish complete it, and `cmake --install` installs both. Exit codes and files are in "
         "[manifest.md](manifest.md).\n" +
         command_text(command, known);
}

}  // namespace trivet::apps
