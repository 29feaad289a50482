/// A library of two parts, a scan of them, and a service that runs while a test talks to it.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/program.hpp"
#include "storage/data/cloud.hpp"
#include "support/temp_dir.hpp"

namespace trivet::test {

class ServeFixture : public testing::Test {
 protected:
  void SetUp() override;

  /// Run the service with these arguments while `body(port)` runs, then end it.
  Outcome serve(std::vector<std::string> arguments, const std::function<void(int port)>& body);
  /// Once: a second signal ends it at once.
  void tell_to_end();

  std::vector<std::string> environment_;  ///< NAME=VALUE, of the service
  const TempDir folder_;                  ///< with l.h5 and camera.json
  std::filesystem::path depth_;           ///< the scan, a depth image
  Camera camera_;                         ///< of the scan
  std::string parameters_;                ///< for it, without the format
  std::string query_;                     ///< the target that recognizes it
  std::atomic<pid_t> process_{0};

 private:
  std::atomic<bool> told_{false};
};

}  // namespace trivet::test
