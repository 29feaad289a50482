#include "apps/program.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>
#include <thread>

#include "support/temp_dir.hpp"

namespace trivet::test {

Outcome run_program(const std::string& program, const std::vector<std::string>& arguments,
                    const Setting& setting) {
  const TempDir output;
  const std::string out = output / "out", error = output / "error";
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::vector<std::string> environment = setting.environment;

  // Closed by a successful exec; otherwise it carries the error. A shell also exits with 127 for a
  // missing program.
  int failure[2];
  if (::pipe2(failure, O_CLOEXEC) != 0) throw std::runtime_error("cannot make a pipe");
  const pid_t child = ::fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) {
    const auto redirect = [](const std::string& file, int descriptor) {
      return ::dup2(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), descriptor) >= 0;
    };
    for (std::string& entry : environment) ::putenv(entry.data());
    if (redirect(out, STDOUT_FILENO) && redirect(error, STDERR_FILENO) &&
        ::chdir(setting.folder.c_str()) == 0) {
      ::execv(argv[0], argv.data());
    }
    const int reason = errno;
    ::_exit(::write(failure[1], &reason, sizeof reason) == sizeof reason ? 127 : 126);
  }
  ::close(failure[1]);
  int reason = 0;
  const bool failed = ::read(failure[0], &reason, sizeof reason) > 0;
  ::close(failure[0]);

  int status = 0;
  while (::waitpid(child, &status, setting.watch ? WNOHANG : 0) == 0) {
    setting.watch(child, read_bytes(error));
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  if (failed) throw std::runtime_error("cannot run " + program + ": " + std::strerror(reason));
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, read_bytes(out), read_bytes(error)};
}

Outcome run_trivet(const std::vector<std::string>& arguments, const Setting& setting) {
  return run_program(TRIVET_PROGRAM, arguments, setting);
}

}  // namespace trivet::test
