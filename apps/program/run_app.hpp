/// What the programs of the command line share: signals, common options, errors to exit codes.
#pragma once

#include <stop_token>

#include "apps/program/context.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// Take over the signals of the process. To be called once, before any thread: Ctrl-C (SIGINT,
/// SIGTERM) once asks the work to stop at the next step, twice ends the program at once; a limit on
/// the size of files becomes an error of the write. Returns the token that asks for the stop.
std::stop_token watch_signals();

/// --threads, --quiet and --progress.
void add_common_options(CLI::App& app, Context& context);

/// Parse the command line, run what was chosen, tell its error. Returns the exit code.
int run_app(CLI::App& app, Context& context, int argc, char** argv);

}  // namespace trivet::apps
