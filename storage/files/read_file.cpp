#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <exception>

#include "storage/files/descriptor.hpp"
#include "storage/files/errno_text.hpp"
#include "storage/files/file.hpp"

namespace trivet {
namespace {

Error changed_meanwhile(const std::filesystem::path& file) {
  return {
      ErrorCode::changed,
      fmt::format("{}: was changed while it was read; read it again when it is written, or write "
                  "it under another name and rename it",
                  file.string())};
}

/// Read a file of the length at opening into a buffer of bytes or characters.
template <class Buffer>
Result<Buffer> read_entire(const std::filesystem::path& file, std::uint64_t max_bytes) {
  TRIVET_TRY_ASSIGN(OpenedFile opened, open_regular(file, max_bytes));
  if (!wait_for_rest(opened)) return changed_meanwhile(file);
  if (opened.identity.size > max_bytes) return changed_meanwhile(file);
  const int descriptor = opened.descriptor.get();
  Buffer bytes;
  try {
    bytes.resize(opened.identity.size);
  } catch (const std::exception&) {
    return Error{ErrorCode::io, fmt::format("{}: not enough memory to read {} bytes", file.string(),
                                            opened.identity.size)};
  }
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      return Error{ErrorCode::io,
                   fmt::format("{}: cannot be read: {}", file.string(), errno_text())};
    }
    if (count == 0) return changed_meanwhile(file);
    size += static_cast<std::size_t>(count);
  }
  struct stat after {};
  if (::fstat(descriptor, &after) != 0 || !FileIdentity::of(after).same_bytes(opened.identity))
    return changed_meanwhile(file);
  return bytes;
}

}  // namespace

Result<std::vector<std::byte>> read_file(const std::filesystem::path& file,
                                         std::uint64_t max_bytes) {
  return read_entire<std::vector<std::byte>>(file, max_bytes);
}

Result<std::string> read_text_file(const std::filesystem::path& file, std::uint64_t max_bytes) {
  return read_entire<std::string>(file, max_bytes);
}

Result<std::vector<std::byte>> read_all(int descriptor, std::string_view name,
                                        std::uint64_t max_bytes) {
  constexpr std::size_t kStep = 1 << 16;
  std::vector<std::byte> bytes;
  std::size_t size = 0;
  while (true) {
    // Doubled, so that data in small pieces is not copied for each.
    if (bytes.size() < size + kStep) bytes.resize(std::max(2 * bytes.size(), kStep));
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      return Error{ErrorCode::io, fmt::format("{}: cannot be read: {}", name, errno_text())};
    size += static_cast<std::size_t>(count);
    if (size > max_bytes) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}: holds more than the limit of {} bytes", name, max_bytes)};
    }
    if (count > 0) continue;
    bytes.resize(size);
    return bytes;
  }
}

}  // namespace trivet
