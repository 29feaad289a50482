#include "apps/commands/in_child.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <string>

namespace trivet::apps {
namespace {

constexpr int kFailed = 1;

/// Sends the code, then the message.
void send(int pipe, const Error& error) {
  const std::string text = std::string(1, static_cast<char>(error.code)) + error.message;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = ::write(pipe, text.data() + sent, text.size() - sent);
    if (n <= 0) return;
    sent += static_cast<std::size_t>(n);
  }
}

std::string receive(int pipe) {
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t n = 0; (n = ::read(pipe, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(n));
  return text;
}

}  // namespace

Result<void> in_child(const std::function<Result<void>()>& work, const Error& broken) {
  std::array<int, 2> pipe{};
  const bool has_pipe = ::pipe2(pipe.data(), O_CLOEXEC) == 0;
  const pid_t child = has_pipe ? ::fork() : -1;
  if (child < 0)
    return Error{ErrorCode::io, fmt::format("cannot make a process: {}", std::strerror(errno))};
  if (child == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const Result<void> done = work();
    if (!done) send(pipe[1], done.error());
    ::_exit(done ? 0 : kFailed);
  }
  ::close(pipe[1]);
  const std::string text = receive(pipe[0]);
  ::close(pipe[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
  if (!WIFEXITED(status) || text.empty()) return broken;
  return Error{static_cast<ErrorCode>(text[0]), text.substr(1)};
}

}  // namespace trivet::apps
