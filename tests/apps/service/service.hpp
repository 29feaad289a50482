/// Programs that run while a test asks them.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "apps/program.hpp"

namespace trivet::test {

/// A program that is ended with the test.
class Background {
 public:
  /// Start it by its path; returns when `is_up` holds of what it has written to standard error, or
  /// when it has ended.
  Background(const std::string& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& folder,
             std::function<bool(const std::string& error)> is_up);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { end(); }

  void signal(int number) const;
  /// Ask it to end, unless it has, and wait for that.
  const Outcome& end();
  const Outcome& wait();  ///< for its end

 private:
  pid_t process_ = 0;
  bool is_over_ = false;
  Outcome outcome_;
  std::thread thread_;
};

/// A `trivet serve`.
class Service {
 public:
  /// Start `trivet ARGUMENTS... --port PORT`; returns when it listens, or has ended. Port 0: any.
  Service(std::vector<std::string> arguments, const std::filesystem::path& folder, int port = 0);

  int port() const { return port_; }  ///< 0 if it did not come to listen
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  Background& process() { return process_; }

 private:
  int port_ = 0;
  Background process_;
};

}  // namespace trivet::test
