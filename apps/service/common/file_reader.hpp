/// Files that are read piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>

namespace trivet::apps::service {

/// Reads one file to its end, of which the size is known.
class FileReader {
 public:
  FileReader() = default;
  FileReader(const std::filesystem::path& file, std::uint64_t bytes)
      : stream_(file, std::ios::binary), left_(bytes) {}
  /// The whole file, as it is now; none: it is not there.
  static std::optional<FileReader> open(const std::filesystem::path& file);

  std::uint64_t left() const { return left_; }
  /// At most as much as is left; 0: it cannot be read.
  std::size_t read(std::span<char> out);

 private:
  std::ifstream stream_;
  std::uint64_t left_ = 0;
};

}  // namespace trivet::apps::service
