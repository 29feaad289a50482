/// Fixture for tests of libraries: each test has a separate folder with one file in it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string_view>

#include "support/temp_dir.hpp"

namespace trivet::test {

class LibraryTest : public ::testing::Test {
 protected:
  const std::filesystem::path& folder() const { return folder_.path(); }
  std::filesystem::path file() const { return folder_ / "lib.h5"; }
  void write_file(std::string_view bytes) const { folder_.write("lib.h5", bytes); }

 private:
  TempDir folder_;
};

}  // namespace trivet::test
