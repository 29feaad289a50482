/// Files that are read piece by piece.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>

namespace trivet::apps::service {

/// Reads a file of known size to its end.
class FileReader {
 public:
  FileReader() = default;
  FileReader(const std::filesystem::path& file, std::uint64_t bytes)
      : stream_(file, std::ios::binary), left_(bytes) {}
  /// Opens the file in its present state; none: it does not exist.
  static std::optional<FileReader> open(const std::filesystem::path& file);

  std::uint64_t left() const { return left_; }
  /// Reads up to the rest of the file. Returns the number of bytes; 0: it cannot be read.
  std::size_t read(std::span<char> out);

 private:
  std::ifstream stream_;
  std::uint64_t left_ = 0;
};

}  // namespace trivet::apps::service
