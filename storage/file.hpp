/// Files as whole buffers, read within bounds and published atomically.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "storage/result.hpp"

namespace trivet {

/// Read-only mapping of a regular file; the mapping survives the file's replacement by rename.
class MappedFile {
 public:
  /// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io.
  static Result<MappedFile> open(const std::filesystem::path& file, std::uint64_t max_bytes);
  std::span<const std::byte> bytes() const noexcept { return {data_.get(), size_}; }
  std::shared_ptr<const std::byte> owner() const noexcept { return data_; }

 private:
  std::shared_ptr<const std::byte> data_;
  std::size_t size_ = 0;
};

/// Write bytes to a temporary file in the same folder, fsync, rename, fsync the folder.
/// Errors: cannot_create, io; the temporary file is removed.
Result<void> publish_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// XXH3-128 as 32 hexadecimal digits.
std::string xxh3_hex(std::span<const std::byte> bytes);

}  // namespace trivet
