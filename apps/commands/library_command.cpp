#include <CLI/CLI.hpp>

#include "apps/commands/library_commands.hpp"

namespace trivet::apps {

void add_library(CLI::App& app, Context& context) {
  CLI::App* command = app.add_subcommand(
      "library",
      "Inspect library files, change them, compare them\n\n"
      "What changes a library takes time for what changes and for copying the rest. The file is\n"
      "replaced as a whole or not at all, and has the bytes of one that was trained so.");
  command->require_subcommand(1);
  add_library_views(*command, context);
  add_library_changes(*command, context);
}

}  // namespace trivet::apps
