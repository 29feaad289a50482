/// The help of all commands as one page: docs/cli.md.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace trivet::apps {

/// Each command below `app` with its options, in Markdown.
std::string markdown_help(const CLI::App& app);

}  // namespace trivet::apps
