/// The subcommands of `trivet library`.
#pragma once

#include "apps/commands/commands.hpp"

namespace trivet::apps {

/// Those that look into libraries: list, info, verify, diff.
void add_library_views(CLI::App& library, Context& context);
/// Those that write libraries: add, remove, rename, merge, import; and export.
void add_library_changes(CLI::App& library, Context& context);

}  // namespace trivet::apps
