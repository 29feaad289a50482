#include "apps/program/run_app.hpp"

#include <fmt/format.h>
#include <pthread.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <exception>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "apps/help/exit_codes.hpp"
#include "apps/options/add_options.hpp"
#include "apps/results/standard_output.hpp"
#include "engine/common/thread_limit.hpp"
#include "storage/files/nearest_name.hpp"
#include "storage/files/numbers.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps {
namespace {

/// Prints the error, if any, and returns its exit code, or 0.
int end_code(const Result<void>& done, const Console& console) {
  if (done) return 0;
  console.error(done.error().message);
  return exit_code(done.error().code);
}

/// The arguments as one line that a shell splits into the same arguments.
std::string command_line(std::span<char* const> arguments) {
  std::string line;
  for (const std::string_view argument : arguments) {
    if (!line.empty()) line += ' ';
    const bool plain =
        !argument.empty() && std::all_of(argument.begin(), argument.end(), [](char c) {
          return formats::is_alphanumeric(c) ||
                 std::string_view("_-./:,=+@%").find(c) != std::string_view::npos;
        });
    if (plain) {
      line += argument;
      continue;
    }
    line += '\'';
    for (const char c : argument) line += c == '\'' ? "'\\''" : std::string(1, c);
    line += '\'';
  }
  return line;
}

/// A line that suggests similar options or commands in place of an unknown one; or nothing.
std::string did_you_mean(const CLI::App& program) {
  std::vector<std::string> names;
  const CLI::App* command = &program;
  for (auto below = command->get_subcommands(); command; below = command->get_subcommands()) {
    for (const CLI::Option* const option : command->get_options()) {
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    if (below.empty()) break;
    command = below.front();
  }
  for (const CLI::App* const below : command->get_subcommands({}))
    names.push_back(below->get_name());
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string& extra : program.remaining(true)) {
    const std::string_view nearest = nearest_name(extra.substr(0, extra.find('=')), known);
    if (!nearest.empty()) return fmt::format("did you mean {}?\n", nearest);
  }
  return "";
}

}  // namespace

std::stop_token watch_signals() {
  std::signal(SIGXFSZ, SIG_IGN);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::stop_source source;
  std::thread([signals, source]() mutable {
    int signal = 0;
    sigwait(&signals, &signal);
    source.request_stop();
    sigwait(&signals, &signal);
    std::_Exit(128 + signal);
  }).detach();
  return source.get_token();
}

void add_common_options(CLI::App& app, Context& context) {
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--threads", context.num_threads,
                 "Threads to use; 0 means all cores. The output does not depend on it.")
      ->check(CLI::Range(0U, 1024U));
  app.add_flag("--quiet", context.console.quiet, "Print results and errors only");
  limit_to(
      app.add_option_function<std::string>(
          "--progress",
          [&context](const std::string& form) { context.console.json_progress = form == "json"; },
          "Format of progress on standard error: text, or json, an object a line with "
          "stage, done, total, item and seconds, also with --quiet"),
      {"text", "json"})
      ->type_name("FORM")
      ->default_str("text");
}

int run_app(CLI::App& app, Context& context, int argc, char** argv) {
  context.command = command_line({argv, static_cast<std::size_t>(argc)});
  try {
    const PlainLocale plain;
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, complaint;
    const bool asked = app.exit(error, help, complaint) == 0;
    context.console.complaint(complaint.str() + did_you_mean(app));
    return asked ? end_code(write_output(help.str()), context.console) : 2;
  }

  try {
    const ThreadLimit limit(context.num_threads);
    return end_code(context.run(), context.console);
  } catch (const std::bad_alloc&) {
    context.console.error(
        "out of memory; use a larger relative step, fewer models or a smaller scene");
    return exit_code(ErrorCode::io);
  } catch (const std::exception& error) {
    context.console.error(
        fmt::format("internal: {}; please report it with the command that led here", error.what()));
    return exit_code(ErrorCode::internal);
  }
}

}  // namespace trivet::apps
