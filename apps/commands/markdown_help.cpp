#include "apps/commands/markdown_help.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <map>
#include <string_view>

namespace trivet::apps {
namespace {

/// What stands in a cell of a table.
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

std::string row(const CLI::Option& option) {
  std::string name = option.get_name(option.get_positional(), true);
  if (const std::string type = option.get_type_name(); !option.get_positional() && !type.empty())
    name += " " + type;
  const std::string usual = option.get_default_str();
  return fmt::format("| `{}` | {} | {}{} |\n", name, usual.empty() ? "" : "`" + usual + "`",
                     option.get_required() ? "Required. " : "", cell(option.get_description()));
}

/// known  tables, and the command that each stands below
std::string command_text(const CLI::App& command, const std::string& name,
                         std::map<std::string, std::string>& known) {
  std::string out = fmt::format("\n## {}\n\n{}\n", name, command.get_description());
  for (const std::string& group : command.get_groups()) {
    std::string rows;
    for (const CLI::Option* const option : command.get_options()) {
      if (option->get_group() == group && option->get_name() != "--help") rows += row(*option);
    }
    if (group.empty() || rows.empty()) continue;
    const auto [first, is_new] = known.emplace(rows, name);
    out += is_new ? fmt::format("\n**{}**\n\n| option | default | meaning |\n|---|---|---|\n{}",
                                group, rows)
                  : fmt::format("\n**{}**: as of `{}`.\n", group, first->second);
  }
  for (const CLI::App* const inner : command.get_subcommands([](const CLI::App*) { return true; }))
    out += command_text(*inner, name + " " + inner->get_name(), known);
  return out;
}

}  // namespace

std::string markdown_help(const CLI::App& app) {
  std::map<std::string, std::string> known;
  return "# Command line\n\nWritten by `trivet --help-markdown > docs/cli.md`. Every command has "
         "`--help`; exit codes and files are in [manifest.md](manifest.md).\n" +
         command_text(app, "trivet", known);
}

}  // namespace trivet::apps
