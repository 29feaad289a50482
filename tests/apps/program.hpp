/// Runs the built `trivet` and other programs as a user or a script would.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace trivet::test {

struct Outcome {
  int exit_code = 0;  ///< 128 + signal for a killed program
  std::string out, error;
};

struct Setting {
  std::filesystem::path folder;          ///< working folder; output goes to files outside it
  std::vector<std::string> environment;  ///< NAME=VALUE, in addition to the test's environment
  /// Called every few milliseconds while the program runs, with its standard error so far.
  std::function<void(pid_t, const std::string& error)> watch;
};

/// Runs a program by its path. Throws std::runtime_error if it cannot be started.
Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                    const Setting& setting);
Outcome run_trivet(const std::vector<std::string>& arguments, const Setting& setting);

}  // namespace trivet::test
