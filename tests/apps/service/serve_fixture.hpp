/// A library of two parts, a scan of them, and a service that runs while a test sends requests to
/// it.
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

  /// Runs the service with these arguments while `body(port)` runs, then ends it.
  Outcome serve(std::vector<std::string> arguments, const std::function<void(int port)>& body);
  /// Sends a signal once: a second one would end the service at once.
  void request_end();

  std::vector<std::string> environment_;  ///< NAME=VALUE, of the service
  const TempDir folder_;                  ///< with l.h5 and camera.json
  std::filesystem::path depth_;           ///< the scan, a depth image
  Camera camera_;                         ///< camera of the scan
  std::string parameters_;                ///< parameters of the scan, without the format
  std::string query_;                     ///< target of a recognition of the scan
  std::atomic<pid_t> process_{0};

 private:
  std::atomic<bool> end_requested_{false};
};

}  // namespace trivet::test
