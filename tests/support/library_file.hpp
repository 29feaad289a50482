/// A folder of its own for each test that writes a library, and the bytes of files.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace trivet::test {

class LibraryTest : public ::testing::Test {
 protected:
  LibraryTest() {
    std::string pattern =
        (std::filesystem::temp_directory_path() / "trivet_library_XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~LibraryTest() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path file() const { return folder_ / "lib.h5"; }

 private:
  std::filesystem::path folder_;
};

inline std::vector<char> bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& file, std::span<const char> bytes) {
  std::ofstream(file, std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace trivet::test
