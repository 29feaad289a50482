/// What a person sees: a progress bar on a terminal, plain lines otherwise, nothing with --quiet;
/// and what a program sees that asks for progress as JSON.
/// No colors: what is said needs none. Names and words of others act on no terminal: they are told
/// by printable_lines(). What standard error does not take is lost, and stops no
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
  bool json_progress = false;  ///< an object a line, whether quiet or not

  void line(std::string_view text) const;     ///< to standard error, unless quiet
  void warning(std::string_view text) const;  ///< to standard error, always
  void wrote_report(const std::filesystem::path& folder) const;  ///< where its page is, as a line
  void error(std::string_view text) const;                       ///< to standard error, always
  void complaint(std::string_view text) const;  ///< of the command line; to standard error, always
  /// A report for Progress: redraws one line on a terminal, prints a line an item otherwise; with
  /// the time that is left. As JSON: {"stage", "done", "total", "item", "seconds"}, of which
  /// `stage` is the verb and `seconds` count from its beginning.
  ///
  /// brief  what mostly takes no time: nothing is told in its first second
  Progress progress(std::string_view verb, std::stop_token stop, bool brief = false) const;
};

}  // namespace trivet::apps
