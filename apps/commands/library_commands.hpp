/// The subcommands of `trivet library`.
#pragma once

#include "apps/commands/commands.hpp"

namespace trivet::apps {

/// The commands that read libraries: list, info, verify, diff.
void add_library_views(CLI::App& library, Context& context);
/// The commands that write libraries: add, remove, rename, merge, import; and export.
void add_library_changes(CLI::App& library, Context& context);

}  // namespace trivet::apps
