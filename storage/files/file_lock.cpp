#include "storage/files/file_lock.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <string>
#include <system_error>

#include "storage/files/errno_text.hpp"
#include "storage/files/file.hpp"

namespace trivet {
namespace {

namespace fs = std::filesystem;

fs::path lock_of(const fs::path& file) {
  return file.parent_path() / fmt::format(".{}.lock", file.filename().string());
}

/// Whether a path still leads to the opened file: the holder of a lock removes its file.
bool is_at(int descriptor, const fs::path& path) {
  struct stat opened {
  }, there{};
  return ::fstat(descriptor, &opened) == 0 && ::stat(path.c_str(), &there) == 0 &&
         opened.st_ino == there.st_ino && opened.st_dev == there.st_dev;
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "an unknown host";
}

std::string holder_of(int descriptor) {
  std::array<char, 512> text{};
  const ssize_t count = ::pread(descriptor, text.data(), text.size() - 1, 0);
  return count > 0 ? std::string(text.data(), static_cast<std::size_t>(count)) : "another process";
}

/// Write the owner for others to read. On a full disk the text may be incomplete.
void say_whose(int descriptor) {
  const std::string text = fmt::format("process {} on {} since {:%F %T}", ::getpid(), host_name(),
                                       fmt::localtime(std::time(nullptr)));
  [[maybe_unused]] const bool written =
      ::ftruncate(descriptor, 0) == 0 && ::pwrite(descriptor, text.data(), text.size(), 0) > 0;
}

}  // namespace

Result<FileLock> FileLock::acquire(const fs::path& given) {
  const fs::path file = behind_links(given);
  const fs::path path = lock_of(file);
  FileLock lock;
  lock.file_ = file;
  while (true) {
    lock.descriptor_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock.descriptor_ < 0) {
      return Error{ErrorCode::cannot_create,
                   fmt::format("{}: cannot be created: {}", file.string(), errno_text())};
    }
    if (::flock(lock.descriptor_, LOCK_EX | LOCK_NB) != 0) {
      const std::string holder = holder_of(lock.descriptor_);
      ::close(std::exchange(lock.descriptor_, -1));
      return Error{ErrorCode::cannot_create,
                   fmt::format("{}: being written by {}; wait until it is done, or stop it",
                               file.string(), holder)};
    }
    if (is_at(lock.descriptor_, path)) break;
    ::close(std::exchange(lock.descriptor_, -1));
  }
  say_whose(lock.descriptor_);
  remove_pending_files(file);
  return lock;
}

FileLock::~FileLock() {
  if (descriptor_ < 0) return;
  ::unlink(lock_of(file_).c_str());
  ::close(descriptor_);
}

}  // namespace trivet
