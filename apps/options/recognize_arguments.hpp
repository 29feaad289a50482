/// The options of recognition on the command line, shared by all commands that recognize scenes.
#pragma once

#include <string>

#include "apps/options/add_options.hpp"
#include "engine/options/recognize_options.hpp"

namespace trivet::apps {

struct RecognizeArguments {
  GivenOption preset;
  GivenOptions given;
  std::string expected;  ///< a file
};

/// `arguments` must live as long as the command.
void add_recognize_options(CLI::App& command, RecognizeArguments& arguments);

/// The preset, overridden by the options given on the command line.
/// Errors: usage (nothing to search and no expected pose to test), or of reading expected poses.
Result<RecognizeOptions> recognize_options(const RecognizeArguments& arguments);

}  // namespace trivet::apps
