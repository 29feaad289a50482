/// File descriptors, and the identity of a file behind one.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <utility>

#include "storage/common/result.hpp"

namespace trivet {

/// A descriptor that is closed automatically.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const noexcept { return number_; }
  explicit operator bool() const noexcept { return number_ >= 0; }

 private:
  int number_ = -1;
};

/// Values that distinguish one state of a file from another. Times are in nanoseconds.
struct FileIdentity {
  dev_t device = 0;
  ino_t inode = 0;
  std::uint64_t size = 0;
  std::int64_t written = 0;  ///< modification time of the bytes; writers can set it
  std::int64_t touched = 0;  ///< change time of bytes and metadata; nobody can set it back
  nlink_t num_names = 0;

  static FileIdentity of(const struct stat& status) noexcept;
  bool same_file(const FileIdentity& other) const noexcept {
    return device == other.device && inode == other.inode;
  }
  bool same_bytes(const FileIdentity& other) const noexcept {
    return same_file(other) && size == other.size && written == other.written;
  }
};

/// A regular file, opened for reading.
struct OpenedFile {
  Descriptor descriptor;
  FileIdentity identity;
};
/// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io.
Result<OpenedFile> open_regular(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Wait until any further change of the bytes would give the file a new modification time. Waits a
/// moment, and only if the file was written just now. Returns whether that point was reached within
/// a second.
bool wait_for_rest(OpenedFile& opened);

}  // namespace trivet
