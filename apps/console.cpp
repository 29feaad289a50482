#include "apps/console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace trivet::apps {

void Console::line(std::string_view text) const {
  if (!quiet) fmt::print(stderr, "{}\n", text);
}

void Console::warning(std::string_view text) const { fmt::print(stderr, "warning: {}\n", text); }

Progress Console::progress(std::string_view verb, std::stop_token stop) const {
  Progress progress;
  progress.stop = std::move(stop);
  if (quiet) return progress;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  progress.report = [terminal, verb = std::string(verb)](std::size_t done, std::size_t total,
                                                         std::string_view item) {
    if (!terminal) {
      fmt::print(stderr, "{} {}/{} {}\n", verb, done, total, item);
      return;
    }
    constexpr std::size_t kWidth = 30;
    const std::size_t filled = total > 0 ? kWidth * done / total : kWidth;
    fmt::print(stderr, "\r\033[K{} [{}{}] {}/{} {}{}", verb, std::string(filled, '#'),
               std::string(kWidth - filled, '.'), done, total, item, done == total ? "\n" : "");
    std::fflush(stderr);
  };
  return progress;
}

}  // namespace trivet::apps
