/// A subcommand that is configured by flags and a file, and runs until it is told to stop.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/commands/commands.hpp"
#include "apps/service/settings_file.hpp"

namespace trivet::apps {

/// What a kind of daemon does with its settings.
template <class Settings>
struct DaemonWork {
  Result<void> (*run)(const Settings& settings, const Context& context);
  /// Opens what the settings name, and says what it found, a line each; none: they name nothing.
  Result<std::string> (*check)(const Settings& settings, const Context& context) = nullptr;
};

/// Settings  of a kind that has settings_of and faults_of
template <class Settings>
void add_daemon(CLI::App& app, Context& context, const std::string& name, const std::string& help,
                const DaemonWork<Settings>& work) {
  auto arguments = std::make_shared<service::SettingArguments>();
  Settings defaults;
  service::add_settings(*app.add_subcommand(name, help), settings_of(defaults), *arguments);
  app.get_subcommand(name)->callback([arguments, work, &context] {
    context.run = [arguments, work, &context]() -> Result<void> {
      Settings settings;
      if (const Result<void> good = read_settings(settings, *arguments); !good) return good.error();
      if (!arguments->check_config) return work.run(settings, context);
      if (work.check) {
        const Result<std::string> found = work.check(settings, context);
        if (!found) return found.error();
        context.console.line(*found);
      }
      context.console.line("the configuration is good");
      return {};
    };
  });
}

}  // namespace trivet::apps
