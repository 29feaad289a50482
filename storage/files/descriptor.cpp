#include "storage/files/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <thread>

#include "storage/files/errno_text.hpp"

namespace trivet {
namespace {

std::int64_t nanoseconds(const timespec& time) {
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

constexpr std::chrono::milliseconds kRetryInterval{1};
constexpr int kMostRetries = 1000;

/// The clock of file times. It advances in steps of some milliseconds, more on a machine that is
/// held up: a second change within one step does not change a file's time.
std::int64_t time_for_files() {
  timespec now{};
  ::clock_gettime(CLOCK_REALTIME_COARSE, &now);
  return nanoseconds(now);
}

}  // namespace

FileIdentity FileIdentity::of(const struct stat& status) noexcept {
  return {status.st_dev,
          status.st_ino,
          static_cast<std::uint64_t>(status.st_size),
          nanoseconds(status.st_mtim),
          nanoseconds(status.st_ctim),
          status.st_nlink};
}

Result<OpenedFile> open_regular(const std::filesystem::path& file, std::uint64_t max_bytes) {
  // Non-blocking: a named pipe without a writer would hang before it could be refused.
  Descriptor descriptor(::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY));
  if (!descriptor) {
    const bool missing = errno == ENOENT || errno == ENOTDIR;
    return Error{missing ? ErrorCode::missing_input : ErrorCode::io,
                 fmt::format("{}: cannot be opened: {}", file.string(), errno_text())};
  }

  struct stat status {};
  if (::fstat(descriptor.get(), &status) != 0) {
    return Error{ErrorCode::io, fmt::format("{}: cannot be read: {}", file.string(), errno_text())};
  }
  if (!S_ISREG(status.st_mode)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("{}: expected a regular file, found a {}", file.string(),
                             S_ISDIR(status.st_mode) ? "folder" : "device, pipe or socket")};
  }
  const FileIdentity identity = FileIdentity::of(status);
  if (identity.size > max_bytes) {
    return Error{ErrorCode::bad_data, fmt::format("{}: holds {} bytes, more than the limit of {}",
                                                  file.string(), identity.size, max_bytes)};
  }
  return OpenedFile{std::move(descriptor), identity};
}

bool wait_for_rest(OpenedFile& opened) {
  for (int attempt = 0; attempt < kMostRetries; ++attempt) {
    // A file time in the future, from another machine's clock, also differs: a change sets an
    // earlier one.
    if (time_for_files() != opened.identity.written) return true;
    std::this_thread::sleep_for(kRetryInterval);
    struct stat status {};
    if (::fstat(opened.descriptor.get(), &status) != 0) return false;
    opened.identity = FileIdentity::of(status);
  }
  return false;
}

}  // namespace trivet
