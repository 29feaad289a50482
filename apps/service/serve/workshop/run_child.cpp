#include "apps/service/serve/workshop/run_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string_view>

#include "storage/files/errno_text.hpp"

namespace trivet::apps::service {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPollMs = 20;
constexpr int kNice = 10;
constexpr std::size_t kMostWords = 4096;  // last bytes of its messages that are kept

/// Runs in the child process, where only system calls are allowed.
[[noreturn]] void become(char* const* arguments, const ChildLimits& limits, int errors) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const rlimit memory{limits.memory_bytes, limits.memory_bytes};
  ::setrlimit(RLIMIT_AS, &memory);
#endif
  (void)!::nice(kNice);
  const int nothing = ::open("/dev/null", O_RDWR);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(nothing, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  ::close_range(STDERR_FILENO + 1, ~0U, 0);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  ::execv(arguments[0], arguments);
  ::_exit(127);
}

/// The last line that is not empty.
std::string_view last_line(std::string_view text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.remove_suffix(1);
  const std::size_t before = text.find_last_of("\n\r");
  return before == std::string_view::npos ? text : text.substr(before + 1);
}

Error what_ended(int status, bool late, bool stopped, const ChildLimits& limits,
                 std::string_view words) {
  if (stopped) return {ErrorCode::resumable, "stopped on request"};
  if (late) return {ErrorCode::bad_data, fmt::format("took longer than {} s", limits.time.count())};
  if (WIFSIGNALED(status)) {
    return {
        ErrorCode::bad_data,
        fmt::format("training it broke down (signal {}): too large or damaged", WTERMSIG(status))};
  }
  const std::string_view line = last_line(words);
  return {ErrorCode::bad_data,
          line.empty() ? fmt::format("training it failed with exit code {}", WEXITSTATUS(status))
                       : std::string(line)};
}

}  // namespace

Result<void> run_child(const std::vector<std::string>& program, const ChildLimits& limits,
                       const std::stop_token& stop) {
  std::vector<char*> arguments;
  for (const std::string& argument : program)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  std::array<int, 2> pipe{};
  const bool has_pipe = ::pipe2(pipe.data(), O_CLOEXEC) == 0;
  const pid_t child = has_pipe ? ::fork() : -1;
  if (child == 0) become(arguments.data(), limits, pipe[1]);
  if (child < 0) {
    const Error error{ErrorCode::internal, fmt::format("cannot make a process: {}", errno_text())};
    for (const int end : pipe) {
      if (has_pipe) ::close(end);
    }
    return error;
  }
  ::close(pipe[1]);

  const Clock::time_point deadline = Clock::now() + limits.time;
  std::string words;
  std::array<char, 4096> part{};
  bool late = false, stopped = false;
  for (bool open = true; open;) {
    late = Clock::now() > deadline;
    stopped = stop.stop_requested();
    if (late || stopped) {
      ::kill(child, SIGKILL);
      break;
    }
    pollfd ready{pipe[0], POLLIN, 0};
    if (::poll(&ready, 1, kPollMs) <= 0) continue;
    const ssize_t n = ::read(pipe[0], part.data(), part.size());
    open = n > 0;
    if (open) words.append(part.data(), static_cast<std::size_t>(n));
    if (words.size() > 2 * kMostWords) words.erase(0, words.size() - kMostWords);
  }
  ::close(pipe[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (!late && !stopped && WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  return what_ended(status, late, stopped, limits, words);
}

}  // namespace trivet::apps::service
