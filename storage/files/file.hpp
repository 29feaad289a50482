/// Whole files, read within bounds and published atomically.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// Processes that may write a file while it is mapped.
enum class Writers : std::uint8_t {
  none,    ///< none: the file belongs to this process or is protected by its lock
  others,  ///< any process: the file is watched
};

/// Read-only mapping of a regular file; the mapping survives replacement of the file by rename.
/// Bytes cut off by truncation read as zeros, and bytes that others write in place change, unless they
/// were copied. Prefer read_file for files that others write and that fit into memory.
class MappedFile {
 public:
  /// Changes of the file since it was opened.
  enum class State : std::uint8_t {
    same,
    touched,  ///< names or rights changed; or bytes changed and the modification time was set back
    changed,  ///< changed in place: bytes may differ. Permanent.
  };

  /// writers  with `others`, a descriptor stays open to detect changes
  /// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io, changed (it
  /// is being written).
  static Result<MappedFile> open(const std::filesystem::path& file, std::uint64_t max_bytes,
                                 Writers writers = Writers::none);
  std::span<const std::byte> bytes() const noexcept;
  std::shared_ptr<const std::byte> owner() const noexcept;

  /// Compare size and times of the file with those at opening: one system call. A change through
  /// the mapping of another process shows once the system updates the time.
  State state() const noexcept;
  /// Time of the last touch, for accept_touch.
  std::int64_t time_of_touch() const noexcept;
  /// Record that the bytes were still the same at this touch.
  void accept_touch(std::int64_t time) const noexcept;
  /// Record that the bytes have changed.
  void condemn() const noexcept;
  /// Copy some bytes of the mapping, and those around them, into memory at the same address. No write
  /// to the file reaches them from then on, but earlier ones did: check them afterwards. Without
  /// effect for Writers::none, and where the system refuses such memory. Thread-safe, but not
  /// together with drop_copies. Errors: no_memory.
  Result<void> copy(std::span<const std::byte> bytes) const;
  /// Whether copies can be made.
  bool has_memory() const noexcept;
  /// Free the memory of all copies: the mapping is that of the file again.
  void drop_copies() const noexcept;
  /// Another mapping of the same file, as it is now. Empty for Writers::none. Errors: io.
  Result<MappedFile> mapped_again() const;

  /// Whether a path leads to this very file or does not exist.
  bool is_at(const std::filesystem::path& file) const noexcept;

 private:
  struct Mapping;
  std::shared_ptr<Mapping> mapping_;
};

/// Read a whole regular file, which others may write at any time.
/// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io, changed (while
/// it was read).
Result<std::vector<std::byte>> read_file(const std::filesystem::path& file,
                                         std::uint64_t max_bytes);
/// As read_file, as text.
Result<std::string> read_text_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Ask the system to load the pages of a mapping before they are read. Many pages requested at once
/// load from a disk in a tenth of the time of one after the other.
void ask_for_pages(std::span<const std::byte> mapped) noexcept;

/// Release the pages of a mapping; reading them again loads them from the file.
void release_pages(std::span<const std::byte> mapped) noexcept;
/// Release the pages around some bytes of a mapping, including those that the system read ahead.
/// Bytes outside the mapping stay.
void release_pages_around(std::span<const std::byte> read,
                          std::span<const std::byte> mapped) noexcept;

/// Release the page cache of a file that is on the disk and is unlikely to be read soon, so that it
/// does not displace other data.
void release_cached_file(const std::filesystem::path& file) noexcept;

/// Read from an open descriptor until its end. `name` stands for it in messages.
/// Errors: bad_data (more than max_bytes), io.
Result<std::vector<std::byte>> read_all(int descriptor, std::string_view name,
                                        std::uint64_t max_bytes);

/// Event that a published file is guaranteed to survive. If publishing does not wait for the disk,
/// a power failure may leave any of the bytes unwritten, so the reader must check them.
enum class Outlasts : std::uint8_t { process, power_failure };

/// Target of a path after all symbolic links; the target need not exist.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// A file that is written under a temporary name and then replaces its target, so that readers see
/// either the old file or the whole new one. It keeps the mode of the old file, and its owner and
/// group as far as the process may set them. For a symbolic link, the target of the link is
/// replaced.
class PendingFile {
 public:
  /// Create with a temporary name in the folder of the target; removed unless published. Errors:
  /// cannot_create (also for a device or a pipe).
  static Result<PendingFile> create(const std::filesystem::path& target);
  /// Create with an unused name in the same file system; stays there if not published. Errors:
  /// cannot_create.
  static Result<PendingFile> create_lasting(const std::filesystem::path& target,
                                            const std::filesystem::path& name);
  PendingFile(PendingFile&& other) noexcept { swap(other); }
  PendingFile& operator=(PendingFile&& other) noexcept {
    swap(other);
    return *this;
  }
  ~PendingFile() { give_up(); }

  const std::filesystem::path& path() const noexcept { return name_; }  ///< name until publication
  int descriptor() const noexcept { return descriptor_; }               ///< open for writing
  bool pending() const noexcept { return descriptor_ >= 0; }  ///< neither published nor given up

  /// Start writing data back to the disk, so that publish() of a large file waits only briefly.
  void start_writeback() const noexcept;
  /// fsync, rename, fsync the folder. If the file need only survive the process, nothing waits for
  /// the disk. Errors: cannot_create (rename), io.
  Result<void> publish(Outlasts end = Outlasts::power_failure);
  /// Release the space beyond this many bytes, where the file system supports it.
  void shrink(std::uint64_t bytes) noexcept;
  /// End writing. A temporary file is removed and its space is released, even while another process
  /// has it open.
  void give_up() noexcept;

 private:
  PendingFile() = default;
  void swap(PendingFile& other) noexcept {
    target_.swap(other.target_);
    name_.swap(other.name_);
    std::swap(lasting_, other.lasting_);
    std::swap(descriptor_, other.descriptor_);
  }

  std::filesystem::path target_, name_;
  bool lasting_ = false;
  int descriptor_ = -1;
};

/// Remove the temporary files that crashed processes left for a target. Files being written now
/// stay.
void remove_pending_files(const std::filesystem::path& target) noexcept;

/// Write bytes as a PendingFile and publish it; what is a device or a pipe is written to, and waits
/// for its reader. Errors: cannot_create, io.
Result<void> publish_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Create a folder and its missing parents. Errors: cannot_create.
Result<void> make_folder(const std::filesystem::path& folder);

/// XXH3-128 checksum.
struct Xxh3 {
  std::uint64_t high = 0, low = 0;

  bool operator==(const Xxh3&) const = default;
  std::string hex() const;  ///< 32 hexadecimal digits, high half first
  /// Parse 32 hexadecimal digits; empty for any other text.
  static std::optional<Xxh3> parse(std::string_view hex);
};
/// The checksum of bytes.
Xxh3 xxh3(std::span<const std::byte> bytes) noexcept;
/// As xxh3, for a mapping; keeps at most 16 MiB of it in memory at a time.
Xxh3 xxh3_of_mapped(std::span<const std::byte> bytes);

/// XXH3-128 checksum as 32 hexadecimal digits.
inline std::string xxh3_hex(std::span<const std::byte> bytes) { return xxh3(bytes).hex(); }

}  // namespace trivet
