#include "apps/commands/console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

namespace trivet::apps {
namespace {

/// How long the rest will take, by what was done so far; empty while that says little.
std::string remaining(double elapsed_seconds, std::size_t done, std::size_t total) {
  if (done >= total || done == 0 || elapsed_seconds < 2) return "";
  const double left =
      elapsed_seconds / static_cast<double>(done) * static_cast<double>(total - done);
  return left < 90 ? fmt::format(", {:.0f} s left", left)
                   : fmt::format(", {:.0f} min left", left / 60);
}

std::string progress_json(const std::string& verb, std::size_t done, std::size_t total,
                          std::string_view item, double seconds) {
  const nlohmann::ordered_json line{{"stage", verb},
                                    {"done", done},
                                    {"total", total},
                                    {"item", item},
                                    {"seconds", std::round(1000 * seconds) / 1000}};
  return line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

/// At once, and whole. There is nobody to tell that it failed.
void tell(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

}  // namespace

void Console::line(std::string_view text) const {
  if (!quiet) tell(fmt::format("{}\n", text));
}

void Console::wrote_report(const std::filesystem::path& folder) const {
  line((folder / "index.html").string());
}

void Console::warning(std::string_view text) const { tell(fmt::format("warning: {}\n", text)); }

void Console::error(std::string_view text) const { tell(fmt::format("error: {}\n", text)); }

Progress Console::progress(std::string_view verb, std::stop_token stop) const {
  Progress progress;
  progress.stop = std::move(stop);
  const auto start = std::chrono::steady_clock::now();
  if (json_progress) {
    progress.report = [verb = std::string(verb), start](std::size_t done, std::size_t total,
                                                        std::string_view item) {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      tell(progress_json(verb, done, total, item, elapsed.count()) + '\n');
    };
    return progress;
  }
  if (quiet) return progress;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  progress.report = [terminal, verb = std::string(verb), start](std::size_t done, std::size_t total,
                                                                std::string_view item) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    const std::string left = remaining(elapsed.count(), done, total);
    if (!terminal) {
      tell(fmt::format("{} {}/{} {}{}\n", verb, done, total, item, left));
      return;
    }
    constexpr std::size_t kWidth = 30;
    const std::size_t filled = total > 0 ? kWidth * done / total : kWidth;
    tell(fmt::format("\r\033[K{} [{}{}] {}/{} {}{}{}", verb, std::string(filled, '#'),
                     std::string(kWidth - filled, '.'), done, total, item, left,
                     done == total ? "\n" : ""));
  };
  return progress;
}

}  // namespace trivet::apps
