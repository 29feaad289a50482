/// Run the built `trivet`, and other programs, as a person or a script would.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace trivet::test {

struct Outcome {
  int exit_code = 0;  ///< 128 + signal for a program that was killed
  std::string out, error;
};

struct Setting {
  std::filesystem::path folder;          ///< to run in; output goes to files outside it
  std::vector<std::string> environment;  ///< NAME=VALUE, beside the test's own
  /// Called every few milliseconds while the program runs, with what it has written to standard
  /// error.
  std::function<void(pid_t, const std::string& error)> watch;
};

/// Run a program by its path. Throws std::runtime_error when it cannot be run at all.
Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                    const Setting& setting);
Outcome run_trivet(const std::vector<std::string>& arguments, const Setting& setting);

}  // namespace trivet::test
