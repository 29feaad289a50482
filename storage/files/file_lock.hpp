/// Exclusive access for the writer of a file.
#pragma once

#include <filesystem>
#include <utility>

#include "storage/common/result.hpp"

namespace trivet {

/// Lock of the one process that may write a file. .FILE.lock beside FILE is locked by flock(2)
/// until this object or its process ends, and holds a line that names the owner. Readers need no
/// lock.
class FileLock {
 public:
  /// Also removes what crashed writers of the file have left behind.
  /// Errors: cannot_create (another process holds the lock, named in the message; or no file can be
  /// created there).
  static Result<FileLock> acquire(const std::filesystem::path& file);
  FileLock(FileLock&& other) noexcept { swap(other); }
  FileLock& operator=(FileLock&& other) noexcept {
    swap(other);
    return *this;
  }
  ~FileLock();

  /// The writable file: the requested path with symbolic links resolved.
  const std::filesystem::path& file() const noexcept { return file_; }

 private:
  FileLock() = default;
  void swap(FileLock& other) noexcept {
    file_.swap(other.file_);
    std::swap(descriptor_, other.descriptor_);
  }

  std::filesystem::path file_;
  int descriptor_ = -1;
};

}  // namespace trivet
