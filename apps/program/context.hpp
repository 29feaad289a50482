/// State shared by all subcommands of a program.
#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "apps/program/console.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps {

struct Context {
  Console console;
  unsigned num_threads = 0;  ///< 0: all cores
  std::string command;       ///< the whole command line, quoted for a shell
  std::stop_token stop;
  std::function<Result<void>()> run;  ///< set by the chosen subcommand
};

}  // namespace trivet::apps
