#include "apps/options/describe_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <string_view>

namespace trivet::apps {
namespace {

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> parts;
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    parts.emplace_back(text.substr(0, comma));
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return parts;
}

/// The choices from the name of an option's check, or from its type, such as "TEXT:{m,mm}".
std::vector<std::string> choices_of(CLI::Option& option) {
  try {
    if (const std::string& named = option.get_validator()->get_name(); !named.empty())
      return split(named);
  } catch (const CLI::OptionNotFound&) {
    return {};
  }
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos) return {};
  return split(std::string_view(type).substr(open + 1, close - open - 1));
}

OptionHelp describe_option(CLI::Option& option) {
  OptionHelp help;
  help.is_argument = option.get_positional();
  help.names = split(option.get_name(help.is_argument, true));
  if (!help.is_argument && option.get_items_expected_max() > 0) help.type = option.get_type_name();
  help.usual = option.get_default_str();
  help.meaning = option.get_description();
  help.choices = choices_of(option);
  help.is_required = option.get_required();
  help.is_list = option.get_delimiter() == ',' || help.type == "A,B,...";
  help.is_repeated = help.is_list || option.get_expected_max() > 1;
  return help;
}

}  // namespace

CommandHelp describe_command(CLI::App& app, const std::string& name) {
  CommandHelp help{name, app.get_description(), app.get_footer(), {}, {}};
  for (const std::string& title : app.get_groups()) {
    OptionGroupHelp group{title, {}};
    for (CLI::Option* const option : app.get_options({})) {
      if (option->get_group() == title && option != app.get_help_ptr())
        group.options.push_back(describe_option(*option));
    }
    if (!title.empty() && !group.options.empty()) help.groups.push_back(std::move(group));
  }
  for (CLI::App* const below : app.get_subcommands([](CLI::App*) { return true; }))
    help.commands.push_back(describe_command(*below, name + ' ' + below->get_name()));
  return help;
}

}  // namespace trivet::apps
