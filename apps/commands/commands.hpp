/// The subcommands. Each adds itself to the command line and runs when chosen.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "apps/commands/console.hpp"
#include "storage/result.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// What all subcommands share.
struct Context {
  Console console;
  unsigned num_threads = 0;  ///< 0: all cores
  std::string command;       ///< the whole command line, as a shell takes it
  std::stop_token stop;
  std::function<Result<void>()> run;  ///< set by the subcommand that was chosen
};

void add_train(CLI::App& app, Context& context);
void add_recognize(CLI::App& app, Context& context);
void add_library(CLI::App& app, Context& context);
void add_evaluate(CLI::App& app, Context& context);
void add_scan(CLI::App& app, Context& context);
void add_mesh(CLI::App& app, Context& context);
void add_calibrate(CLI::App& app, Context& context);
void add_fit_score(CLI::App& app, Context& context);
void add_serve(CLI::App& app, Context& context);
void add_route(CLI::App& app, Context& context);
void add_load(CLI::App& app, Context& context);
void add_study(CLI::App& app, Context& context);
/// Options that print what all commands say of themselves: after the commands.
void add_documents(CLI::App& app);

}  // namespace trivet::apps
