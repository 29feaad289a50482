/// One writer of a file at a time.
#pragma once

#include <filesystem>
#include <utility>

#include "storage/common/result.hpp"

namespace trivet {

/// Held by the one process that may write a file: beside FILE lies .FILE.lock, locked by flock(2)
/// until this ends or its process dies, with a line that says whose it is. Readers need none.
class FileLock {
 public:
  /// Also removes what writers of the file that died have left of it.
  /// Errors: cannot_create (another process holds it: says which; or no file can be made there).
  static Result<FileLock> acquire(const std::filesystem::path& file);
  FileLock(FileLock&& other) noexcept { swap(other); }
  FileLock& operator=(FileLock&& other) noexcept {
    swap(other);
    return *this;
  }
  ~FileLock();

  /// That may be written: behind the links of what was asked for.
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
