/// The subcommands. Each adds itself to the command line and runs when chosen.
#pragma once

#include "apps/program/context.hpp"

namespace CLI {
class App;
}

namespace trivet::apps {

void add_train(CLI::App& app, Context& context);
void add_recognize(CLI::App& app, Context& context);
void add_library(CLI::App& app, Context& context);
void add_evaluate(CLI::App& app, Context& context);
void add_compare(CLI::App& app, Context& context);
void add_scan(CLI::App& app, Context& context);
void add_mesh(CLI::App& app, Context& context);
void add_calibrate(CLI::App& app, Context& context);
void add_fit_score(CLI::App& app, Context& context);
void add_serve(CLI::App& app, Context& context);
void add_study(CLI::App& app, Context& context);
/// Adds the options that print the descriptions of all commands. Call it after the commands were
/// added.
void add_documents(CLI::App& app);

}  // namespace trivet::apps
