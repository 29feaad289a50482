/// Programs that run in the background of a test.
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
  /// Starts a program by its path. Returns when `is_up` is true of its standard error, or when it
  /// has ended.
  Background(const std::string& program, const std::vector<std::string>& arguments,
             const std::filesystem::path& folder,
             std::function<bool(const std::string& error)> is_up);
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;
  ~Background() { end(); }

  void signal(int number) const;
  /// Requests the end of the program, unless it has ended, and waits for it.
  const Outcome& end();
  const Outcome& wait();  ///< waits for its end

 private:
  pid_t process_ = 0;
  bool has_ended_ = false;
  Outcome outcome_;
  std::thread thread_;
};

/// A `trivet serve`.
class Service {
 public:
  /// Starts `trivet ARGUMENTS... --port PORT`; returns when it listens, or has ended. Port 0: any.
  Service(std::vector<std::string> arguments, const std::filesystem::path& folder, int port = 0);

  int port() const { return port_; }  ///< 0 if it never listened
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  Background& process() { return process_; }

 private:
  int port_ = 0;
  Background process_;
};

}  // namespace trivet::test
