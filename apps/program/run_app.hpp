/// Common parts of the command line programs: signals, common options, exit codes of errors.
#pragma once

#include <stop_token>

#include "apps/program/context.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

/// Handles the signals of the process. Call it once, before any thread starts. The first Ctrl-C
/// (SIGINT, SIGTERM) stops the work at the next step, the second ends the program at once. A limit
/// on the size of files becomes an error of the write. Returns the token that requests the stop.
std::stop_token watch_signals();

/// --threads, --quiet and --progress.
void add_common_options(CLI::App& app, Context& context);

/// Parses the command line, runs the chosen command and prints its error. Returns the exit code.
int run_app(CLI::App& app, Context& context, int argc, char** argv);

}  // namespace trivet::apps
