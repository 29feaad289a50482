/// trivet: recognize known rigid objects in 3-D scans.

#include <fmt/format.h>
#include <pthread.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <csignal>
#include <exception>
#include <iostream>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <thread>

#include "apps/commands/commands.hpp"
#include "apps/help/command_help.hpp"
#include "apps/help/exit_codes.hpp"
#include "apps/options/add_options.hpp"
#include "apps/results/standard_output.hpp"
#include "engine/progress.hpp"

namespace {

using namespace trivet;

/// 0, or what an error that is told stands for.
int end_code(const Result<void>& done, const apps::Console& console) {
  if (done) return 0;
  console.error(done.error().message);
  return apps::exit_code(done.error().code);
}

/// Ctrl-C once asks the work to stop at the next step; twice ends the program at once.
class InterruptWatch {
 public:
  InterruptWatch() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::thread([signals = signals_, source = source_]() mutable {
      int signal = 0;
      sigwait(&signals, &signal);
      source.request_stop();
      sigwait(&signals, &signal);
      std::_Exit(128 + signal);
    }).detach();
  }
  std::stop_token token() const { return source_.get_token(); }

 private:
  sigset_t signals_{};
  std::stop_source source_;
};

/// The arguments as one line that a shell splits into them again.
std::string command_line(std::span<char* const> arguments) {
  std::string line;
  for (const std::string_view argument : arguments) {
    if (!line.empty()) line += ' ';
    const bool plain =
        !argument.empty() && std::all_of(argument.begin(), argument.end(), [](char c) {
          return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
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

}  // namespace

int main(int argc, char** argv) {
  std::signal(
      SIGXFSZ,
      SIG_IGN);  // a file-size limit shall be an error of the write, not the end of the process
  const InterruptWatch interrupt;
  apps::Context context;
  context.stop = interrupt.token();
  context.command = command_line({argv, static_cast<std::size_t>(argc)});

  CLI::App app{
      "Recognize known rigid objects in 3-D scans.\n"
      "Train a library once, then find its models in scenes:\n\n"
      "  trivet train MODELS/ -o LIBRARY.h5\n"
      "  trivet recognize LIBRARY.h5 SCENE.ply --json -\n"};
  app.set_version_flag("--version", "trivet " TRIVET_VERSION)->group(apps::kAbout);
  app.require_subcommand(1);
  app.fallthrough();
  app.add_option("--threads", context.num_threads,
                 "Threads to use; 0 means all cores. The output does not depend on it.")
      ->check(CLI::Range(0U, 1024U));
  app.add_flag("--quiet", context.console.quiet, "Print results and errors only");
  apps::limit_to(
      app.add_option_function<std::string>(
          "--progress",
          [&](const std::string& form) { context.console.json_progress = form == "json"; },
          "How progress is told on standard error: text, or json, an object a line with "
          "stage, done, total, item and seconds, also with --quiet"),
      {"text", "json"})
      ->type_name("FORM")
      ->default_str("text");
  apps::add_train(app, context);
  apps::add_recognize(app, context);
  apps::add_evaluate(app, context);
  apps::add_scan(app, context);
  apps::add_mesh(app, context);
  apps::add_calibrate(app, context);
  apps::add_fit_score(app, context);
  apps::add_study(app, context);
  apps::add_serve(app, context);
  apps::add_route(app, context);
  apps::add_load(app, context);
  apps::add_library(app, context);
  apps::add_documents(app);

  if (argc > 1 && std::string_view(argv[1]) == "recognise") {
    context.console.line("trivet recognise is trivet recognize");
    static std::string recognize = "recognize";
    argv[1] = recognize.data();
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::ostringstream help, complaint;
    const bool asked = app.exit(error, help, complaint) == 0;
    std::cerr << complaint.str();
    return asked ? end_code(apps::write_output(help.str()), context.console) : 2;
  }

  try {
    const ThreadLimit limit(context.num_threads);
    return end_code(context.run(), context.console);
  } catch (const std::bad_alloc&) {
    context.console.error(
        "out of memory; use a larger relative step, fewer models or a smaller scene");
    return apps::exit_code(ErrorCode::io);
  } catch (const std::exception& error) {
    context.console.error(
        fmt::format("internal: {}; please report it with the command that led here", error.what()));
    return apps::exit_code(ErrorCode::internal);
  }
}
