#include "apps/program/console.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "storage/common/valid_text.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps {
namespace {

using Clock = std::chrono::steady_clock;

/// The progress shown so far.
struct ProgressState {
  Clock::time_point start = Clock::now(), last{};
  std::optional<std::size_t> done_at_first;  // items done at the time of the first report

  double seconds() const { return std::chrono::duration<double>(Clock::now() - start).count(); }
};

/// The speed and the remaining time, estimated from the items since the first report; empty if
/// there were none.
std::string pace(const ProgressState& state, std::size_t done, std::size_t total) {
  const double seconds = state.seconds();
  if (done >= total || done <= *state.done_at_first || seconds <= 0) return "";
  const double rate = static_cast<double>(done - *state.done_at_first) / seconds;
  const double left = static_cast<double>(total - done) / rate;
  return fmt::format(
      ", {:.{}f}/s, {}", rate, rate < 10 ? 1 : 0,
      left < 90 ? fmt::format("{:.0f} s left", left) : fmt::format("{:.0f} min left", left / 60));
}

constexpr std::size_t kMostLines = 100;
constexpr std::chrono::milliseconds kBetween{500};

std::string progress_json(const std::string& verb, std::size_t done, std::size_t total,
                          std::string_view item, double seconds) {
  const nlohmann::ordered_json line{{"stage", verb},
                                    {"done", done},
                                    {"total", total},
                                    {"item", item},
                                    {"seconds", std::round(1000 * seconds) / 1000}};
  return json_text(line);
}

/// Writes the text at once and as a whole. A failure cannot be reported anywhere.
void write_stderr(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

}  // namespace

void Console::line(std::string_view text) const {
  if (!quiet) write_stderr(printable_lines(fmt::format("{}\n", text)));
}

void Console::wrote_report(const std::filesystem::path& folder) const {
  line((folder / "index.html").string());
}

void Console::warning(std::string_view text) const {
  write_stderr(printable_lines(fmt::format("warning: {}\n", text)));
}

void Console::error(std::string_view text) const {
  write_stderr(printable_lines(fmt::format("error: {}\n", text)));
}

void Console::complaint(std::string_view text) const { write_stderr(printable_lines(text)); }

Progress Console::progress(std::string_view verb, std::stop_token stop, bool brief) const {
  Progress progress;
  progress.stop = std::move(stop);
  ProgressState state;
  if (json_progress) {
    progress.report = [verb = std::string(verb), state](std::size_t done, std::size_t total,
                                                        std::string_view item) {
      write_stderr(progress_json(verb, done, total, item, state.seconds()) + '\n');
    };
    return progress;
  }
  if (quiet) return progress;
  const bool terminal = ::isatty(STDERR_FILENO) == 1;
  progress.report = [terminal, brief, verb = std::string(verb), state](
                        std::size_t done, std::size_t total, std::string_view item) mutable {
    if (!state.done_at_first) {
      state.done_at_first = done < total && item.empty() ? done : 0;
      if (item.empty()) state.start = Clock::now();
    }
    if (brief && state.seconds() < 1) return;
    // With many items, a log gets a line now and then.
    const bool is_due =
        done == total || (total <= kMostLines && !brief) || Clock::now() - state.last > kBetween;
    if (!is_due) return;
    state.last = Clock::now();
    const std::string rest =
        fmt::format("{}{}{}", item.empty() ? "" : " ", printable(item), pace(state, done, total));
    if (!terminal) {
      write_stderr(fmt::format("{} {}/{}{}\n", verb, done, total, rest));
      return;
    }
    constexpr std::size_t kWidth = 30;
    const std::size_t filled = total > 0 ? kWidth * done / total : kWidth;
    write_stderr(fmt::format("\r\033[K{} [{}{}] {}/{}{}{}", verb, std::string(filled, '#'),
                             std::string(kWidth - filled, '.'), done, total, rest,
                             done == total ? "\n" : ""));
  };
  return progress;
}

}  // namespace trivet::apps
