/// A subcommand that is configured by flags and a file, and runs until it is told to stop.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "apps/commands/commands.hpp"
#include "apps/service/settings_file.hpp"

namespace trivet::apps {

/// Settings  of a kind that has settings_of and faults_of
template <class Settings>
void add_daemon(CLI::App& app, Context& context, const std::string& name, const std::string& help,
                Result<void> (*work)(const Settings& settings, const Context& context)) {
  auto arguments = std::make_shared<service::SettingArguments>();
  Settings defaults;
  service::add_settings(*app.add_subcommand(name, help), settings_of(defaults), *arguments);
  app.get_subcommand(name)->callback([arguments, work, &context] {
    context.run = [arguments, work, &context]() -> Result<void> {
      Settings settings;
      if (const Result<void> good = read_settings(settings, *arguments); !good) return good.error();
      if (!arguments->check_config) return work(settings, context);
      context.console.line("the configuration is good");
      return {};
    };
  });
}

}  // namespace trivet::apps
