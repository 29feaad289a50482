/// Messages of a program on standard error. People see a progress bar on a terminal, plain lines
/// otherwise, and nothing with --quiet. Programs can request progress as JSON. There are no colors:
/// the text alone is sufficient. Names and texts from outside are escaped by printable_lines(), so
/// that they cannot control a terminal. Failed writes to standard error are ignored and stop no
/// work.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

#include "engine/common/progress.hpp"

namespace trivet::apps {

class Console {
 public:
  bool quiet = false;
  bool json_progress = false;  ///< one object per line, whether quiet or not

  void line(std::string_view text) const;     ///< prints to standard error, unless quiet
  void warning(std::string_view text) const;  ///< prints to standard error, always
  void wrote_report(const std::filesystem::path& folder) const;  ///< prints the page's location
  void error(std::string_view text) const;      ///< prints to standard error, always
  void complaint(std::string_view text) const;  ///< command line error; to standard error, always
  /// A callback for Progress. On a terminal it redraws one line, otherwise it prints a line per
  /// item; with the remaining time. As JSON: {"stage", "done", "total", "item", "seconds"}, where
  /// `stage` is the verb and `seconds` count from its beginning.
  ///
  /// brief  for steps that usually take no time: nothing is shown in the first second
  Progress progress(std::string_view verb, std::stop_token stop, bool brief = false) const;
};

}  // namespace trivet::apps
