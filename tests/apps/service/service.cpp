#include "apps/service/service.hpp"

#include <algorithm>
#include <csignal>
#include <future>
#include <memory>
#include <regex>
#include <utility>

namespace trivet::test {
namespace {

std::vector<std::string> with_port(std::vector<std::string> arguments, int port) {
  arguments.insert(arguments.end(), {"--port", std::to_string(port)});
  if (std::ranges::find(arguments, "--drain-grace-ms") == arguments.end())
    arguments.insert(arguments.end(), {"--drain-grace-ms", "50"});
  return arguments;
}

}  // namespace

Background::Background(const std::string& program, const std::vector<std::string>& arguments,
                       const std::filesystem::path& folder,
                       std::function<bool(const std::string& error)> is_up) {
  std::promise<pid_t> up;
  std::future<pid_t> process_id = up.get_future();
  thread_ = std::thread([=, this, up = std::move(up)]() mutable {
    bool is_set = false;
    const auto watch = [&](pid_t process, const std::string& error) {
      if (is_set || !is_up(error)) return;
      is_set = true;
      up.set_value(process);
    };
    outcome_ =
        run_program(program, arguments, {.folder = folder, .environment = {}, .watch = watch});
    if (!is_set) up.set_value(0);
  });
  process_ = process_id.get();
}

void Background::signal(int number) const {
  if (process_ > 0 && !has_ended_) ::kill(process_, number);
}

const Outcome& Background::end() {
  signal(SIGTERM);
  return wait();
}

const Outcome& Background::wait() {
  if (thread_.joinable()) thread_.join();
  has_ended_ = true;
  return outcome_;
}

Service::Service(std::vector<std::string> arguments, const std::filesystem::path& folder, int port)
    : process_(TRIVET_PROGRAM, with_port(std::move(arguments), port), folder,
               [this](const std::string& error) {
                 static const std::regex kAddress("http://[0-9.]+:([0-9]+)");
                 std::smatch found;
                 const bool is_up = std::regex_search(error, found, kAddress);
                 if (is_up) port_ = std::stoi(found[1]);
                 return is_up;
               }) {}

}  // namespace trivet::test
