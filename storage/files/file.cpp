#include "storage/files/file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <memory>
#include <new>
#include <system_error>

#include "storage/files/descriptor.hpp"
#include "storage/files/errno_text.hpp"

namespace trivet {
namespace {

Error cannot_create(const std::filesystem::path& file) {
  return {write_error(errno, ErrorCode::cannot_create),
          fmt::format("{}: cannot be created: {}", file.string(), errno_text())};
}

/// Create a file for writing; negative if it exists or cannot be created (errno).
int create_new(const std::filesystem::path& file) {
  return ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

constexpr std::string_view kPendingEnd = ".tmp";
std::string pending_prefix(const std::filesystem::path& target) {
  return fmt::format(".{}.", target.filename().string());
}

/// Copy mode, owner and group from the file to be replaced, as far as this process may. Users who
/// could not read the old file cannot read the new one.
void copy_permissions(int descriptor, const std::filesystem::path& target) noexcept {
  struct stat before {
  }, mine{};
  if (::stat(target.c_str(), &before) != 0 || ::fstat(descriptor, &mine) != 0) return;
  mode_t mode = before.st_mode & 0777U;
  constexpr auto kSame = static_cast<uid_t>(-1);
  const bool has_group =
      before.st_gid == mine.st_gid || ::fchown(descriptor, kSame, before.st_gid) == 0;
  // The new file's group has other members.
  if (!has_group) mode &= ~mode_t{070U} | ((mode & 07U) << 3U);
  if (before.st_uid != mine.st_uid) [[maybe_unused]]
    const int allowed = ::fchown(descriptor, before.st_uid, kSame);
  ::fchmod(descriptor, mode);
}

bool write_all(int descriptor, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

/// Whether a path leads to something that is written to, not replaced: a device such as /dev/null, a
/// pipe, a terminal.
bool is_stream(const std::filesystem::path& file) noexcept {
  struct stat found {};
  return ::stat(file.c_str(), &found) == 0 && (S_ISCHR(found.st_mode) || S_ISFIFO(found.st_mode) ||
                                               S_ISSOCK(found.st_mode) || S_ISBLK(found.st_mode));
}

Error cannot_write(const std::filesystem::path& file, std::size_t bytes) {
  return {write_error(errno, ErrorCode::io),
          fmt::format("{}: writing {} bytes failed: {}", file.string(), bytes, errno_text())};
}

void advise(std::span<const std::byte> mapped, int advice) noexcept {
  const auto at = reinterpret_cast<std::uintptr_t>(mapped.data());
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const std::uintptr_t first = at / page * page;
  ::madvise(reinterpret_cast<void*>(first), mapped.size() + (at - first), advice);
}

}  // namespace

void ask_for_pages(std::span<const std::byte> mapped) noexcept { advise(mapped, MADV_WILLNEED); }

void release_pages(std::span<const std::byte> mapped) noexcept { advise(mapped, MADV_DONTNEED); }

// When one byte is read, Linux maps the 64 KiB around it, or a whole large folio, of which it may
// have read up to 2 MiB at once.
void release_pages_around(std::span<const std::byte> read,
                          std::span<const std::byte> mapped) noexcept {
  constexpr std::size_t kAround = std::size_t{2} << 20U;
  const auto at = [](const std::byte* byte) { return reinterpret_cast<std::uintptr_t>(byte); };
  if (read.empty() || at(read.data()) < at(mapped.data())) return;
  const std::size_t first = at(read.data()) - at(mapped.data()), end = first + read.size();
  if (end > mapped.size()) return;
  const std::size_t from = first - std::min(first, kAround);
  release_pages(mapped.subspan(from, std::min(end + kAround, mapped.size()) - from));
}

void release_cached_file(const std::filesystem::path& file) noexcept {
  const Descriptor opened(::open(file.c_str(), O_RDONLY | O_CLOEXEC));
  if (opened) (void)::posix_fadvise(opened.get(), 0, 0, POSIX_FADV_DONTNEED);
}

std::filesystem::path behind_links(const std::filesystem::path& file) {
  constexpr int kMostLinks = 40;  // Linux's limit
  std::filesystem::path at = file;
  for (int i = 0; i < kMostLinks; ++i) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(at, error);
    if (error) break;
    at = at.parent_path() / next;
  }
  return at;
}

Result<PendingFile> PendingFile::create(const std::filesystem::path& given) {
  PendingFile file;
  if (is_stream(given)) {
    return Error{ErrorCode::cannot_create,
                 fmt::format("{}: expected a file, found a device or a pipe, which cannot be "
                             "replaced by one",
                             given.string())};
  }
  const std::filesystem::path target = behind_links(given);
  file.target_ = target;
  const auto folder = folder_of(target);
  // Each writer uses a unique name: two of them never share a temporary file.
  for (int attempt = 0; file.descriptor_ < 0; ++attempt) {
    file.name_ =
        folder / fmt::format("{}{}.{}{}", pending_prefix(target), ::getpid(), attempt, kPendingEnd);
    file.descriptor_ = create_new(file.name_);
    if (file.descriptor_ < 0 && errno != EEXIST) return cannot_create(target);
  }
  return file;
}

Result<PendingFile> PendingFile::create_lasting(const std::filesystem::path& target,
                                                const std::filesystem::path& name) {
  PendingFile file;
  file.target_ = behind_links(target);
  file.name_ = name;
  file.lasting_ = true;
  file.descriptor_ = create_new(name);
  if (file.descriptor_ < 0) return cannot_create(name);
  return file;
}

// Errors here are reported by fsync.
void PendingFile::start_writeback() const noexcept {
  [[maybe_unused]] const int ignored = ::sync_file_range(descriptor_, 0, 0, SYNC_FILE_RANGE_WRITE);
}

Result<void> PendingFile::publish(Outlasts end) {
  if (end == Outlasts::process) start_writeback();
  if (end == Outlasts::power_failure && ::fsync(descriptor_) != 0) {
    Error error{
        write_error(errno, ErrorCode::io),
        fmt::format("{}: cannot be brought to the disk: {}", target_.string(), errno_text())};
    give_up();
    return error;
  }
  copy_permissions(descriptor_, target_);
  if (::rename(name_.c_str(), target_.c_str()) != 0) {
    Error error = cannot_create(target_);
    give_up();
    return error;
  }
  ::close(std::exchange(descriptor_, -1));
  if (end == Outlasts::process) return {};

  // The rename itself must survive a power failure; some file systems cannot sync a folder
  // (EINVAL).
  const auto folder = folder_of(target_);
  const Descriptor parent(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!parent || (::fsync(parent.get()) != 0 && errno != EINVAL)) {
    return Error{ErrorCode::io,
                 fmt::format("{}: the folder cannot be synced: {}", folder.string(), errno_text())};
  }
  return {};
}

void PendingFile::shrink(std::uint64_t bytes) noexcept {
  [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(bytes));
}

void PendingFile::give_up() noexcept {
  if (!pending()) return;
  if (!lasting_) {
    shrink(0);
    ::unlink(name_.c_str());
  }
  ::close(std::exchange(descriptor_, -1));
}

void remove_pending_files(const std::filesystem::path& given) noexcept {
  const std::filesystem::path target = behind_links(given);
  const std::string prefix = pending_prefix(target);
  std::error_code error;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(target), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix) || !name.ends_with(kPendingEnd)) continue;
    const auto numbers = std::string_view(name).substr(
        prefix.size(), name.size() - prefix.size() - kPendingEnd.size());
    if (numbers.find_first_not_of("0123456789.") == numbers.npos) found.push_back(entry.path());
  }
  for (const std::filesystem::path& file : found) std::filesystem::remove(file, error);
}

Result<void> publish_file(const std::filesystem::path& file, std::span<const std::byte> bytes) {
  if (is_stream(file)) {
    const Descriptor stream(::open(file.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (!stream) return cannot_create(file);
    if (!write_all(stream.get(), bytes)) return cannot_write(file, bytes.size());
    return {};
  }
  TRIVET_TRY_ASSIGN(auto pending, PendingFile::create(file));
  if (!write_all(pending.descriptor(), bytes)) return cannot_write(file, bytes.size());
  return pending.publish();
}

Result<void> make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return {};
  return Error{write_error(error.value(), ErrorCode::cannot_create),
               fmt::format("{}: {}", folder.string(), error.message())};
}

std::string Xxh3::hex() const { return fmt::format("{:016x}{:016x}", high, low); }

std::optional<Xxh3> Xxh3::parse(std::string_view hex) {
  constexpr std::size_t kDigits = 16;
  if (hex.size() != 2 * kDigits) return std::nullopt;
  Xxh3 out;
  for (const auto& [half, digits] :
       {std::pair(&out.high, hex.substr(0, kDigits)), std::pair(&out.low, hex.substr(kDigits))}) {
    const char* const end = digits.data() + digits.size();
    const auto [at, error] = std::from_chars(digits.data(), end, *half, 16);
    if (error != std::errc() || at != end) return std::nullopt;
  }
  return out;
}

Xxh3 xxh3(std::span<const std::byte> bytes) noexcept {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {hash.high64, hash.low64};
}

Xxh3 xxh3_of_mapped(std::span<const std::byte> bytes) {
  constexpr std::size_t kPiece = std::size_t{1} << 24;
  if (bytes.size() <= kPiece) return xxh3(bytes);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       &XXH3_freeState);
  if (!state || XXH3_128bits_reset(state.get()) != XXH_OK) throw std::bad_alloc();
  for (std::size_t from = 0; from < bytes.size(); from += kPiece) {
    const auto piece = bytes.subspan(from, std::min(kPiece, bytes.size() - from));
    (void)XXH3_128bits_update(state.get(), piece.data(), piece.size());
    release_pages(piece);
  }
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return {hash.high64, hash.low64};
}

}  // namespace trivet
