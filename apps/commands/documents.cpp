#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "apps/commands/commands.hpp"
#include "apps/help/completion.hpp"
#include "apps/help/man_page.hpp"
#include "apps/help/markdown_help.hpp"
#include "apps/options/add_options.hpp"
#include "apps/options/describe_command.hpp"

namespace trivet::apps {

void add_documents(CLI::App& app) {
  // CLI11 prints the text of the exception.
  const auto print = [](const std::string& text) { throw CLI::CallForVersion(text, 0); };
  app.add_flag_callback(
         "--help-markdown", [=, &app] { print(markdown_help(describe_command(app, "trivet"))); },
         "Print the help of all commands as one page")
      ->trigger_on_parse()
      ->group(kAbout);
  std::vector<std::string> pages{"trivet"};
  for (const CLI::App* const command : app.get_subcommands({}))
    pages.push_back(command->get_name());
  const auto add = [&](const char* name, const char* type, const char* help,
                       const std::vector<std::string>& values,
                       std::string (*text)(const CommandHelp&, const std::string&)) {
    const auto print_one = [=, &app](const std::string& value) {
      print(text(describe_command(app, "trivet"), value));
    };
    limit_to(app.add_option_function<std::string>(name, print_one, help), values)
        ->type_name(type)
        ->trigger_on_parse()
        ->group(kAbout);
  };
  add("--man", "COMMAND", "Print the manual page of a command, or of trivet itself", pages,
      man_page);
  add("--completion", "SHELL",
      "Print what lets a shell complete commands, options and values: bash, zsh or fish",
      {"bash", "zsh", "fish"}, completion);
}

}  // namespace trivet::apps
