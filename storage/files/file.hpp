/// Files as whole buffers, read within bounds and published atomically.
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

/// Who may write a file while it is mapped.
enum class Writers : std::uint8_t {
  none,    ///< it is this process's own, or held by its lock
  others,  ///< anybody: it is watched
};

/// Read-only mapping of a regular file; the mapping survives the file's replacement by rename. Bytes
/// that are cut off read as zeros. What others write and is not larger than memory is better read.
class MappedFile {
 public:
  /// What became of the file since it was opened.
  enum class State : std::uint8_t {
    same,
    touched,  ///< its names or rights were changed; or its bytes, and the time of that was set back
    changed,  ///< in place: bytes may be others than they were. It stays so.
  };

  /// writers  with `others` a descriptor stays open, by which changes are seen
  /// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io, changed (it is
  /// being written).
  static Result<MappedFile> open(const std::filesystem::path& file, std::uint64_t max_bytes,
                                 Writers writers = Writers::none);
  std::span<const std::byte> bytes() const noexcept;
  std::shared_ptr<const std::byte> owner() const noexcept;

  /// Compare size and times of the opened file with those that it was opened with: a system call. A
  /// change through somebody's own mapping shows when the system gives it a time.
  State state() const noexcept;
  /// When it was touched last, for accept_touch.
  std::int64_t time_of_touch() const noexcept;
  /// What was touched then holds the bytes that it held.
  void accept_touch(std::int64_t time) const noexcept;
  /// It is found to hold others.
  void condemn() const noexcept;
  /// Whether a path leads to this very file, or nowhere.
  bool is_at(const std::filesystem::path& file) const noexcept;

 private:
  struct Mapping;
  std::shared_ptr<Mapping> mapping_;
};

/// All of a regular file, which others may write at any time.
/// Errors: missing_input, bad_data (not a regular file, larger than max_bytes), io, changed (while it
/// was read).
Result<std::vector<std::byte>> read_file(const std::filesystem::path& file,
                                         std::uint64_t max_bytes);
/// The same as text.
Result<std::string> read_text_file(const std::filesystem::path& file, std::uint64_t max_bytes);

/// Ask for the pages of a mapping before they are read: many that are asked for at once come from
/// a disk in a tenth of the time that they take one after the other.
void ask_for_pages(std::span<const std::byte> mapped) noexcept;

/// Let go of the pages of a mapping; reading them again brings them back from the file.
void give_back_pages(std::span<const std::byte> mapped) noexcept;
/// Let go of those that hold some bytes of a mapping, and of what the system brought in around them.
/// Bytes that lie elsewhere stay.
void give_back_around(std::span<const std::byte> read, std::span<const std::byte> mapped) noexcept;

/// Let go of the memory that holds what was read and written of a file that is on the disk: of a file
/// that is hardly going to be read soon, so that it does not displace what is.
void give_back_file(const std::filesystem::path& file) noexcept;

/// All that an open descriptor gives until its end. `name` stands for it in messages.
/// Errors: bad_data (more than max_bytes), io.
Result<std::vector<std::byte>> read_all(int descriptor, std::string_view name,
                                        std::uint64_t max_bytes);

/// What a published file is sure to outlast. Without waiting for the disk, a power failure may leave
/// any of its bytes unwritten: its reader must check them.
enum class Outlasts : std::uint8_t { process, power_failure };

/// What a path stands for: the end of its symbolic links, where something may not be yet.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// A file written under another name, whose target's place it then takes: readers see the old file or
/// the whole new one. It takes over the old one's mode, and owner and group as far as the process may
/// give them; of a symbolic link the target is replaced.
class PendingFile {
 public:
  /// Under a temporary name in the folder of the target; without publish it is removed. Errors:
  /// cannot_create.
  static Result<PendingFile> create(const std::filesystem::path& target);
  /// Under a name that nothing has yet, in the same file system; without publish it stays there.
  /// Errors: cannot_create.
  static Result<PendingFile> create_lasting(const std::filesystem::path& target,
                                            const std::filesystem::path& name);
  PendingFile(PendingFile&& other) noexcept { swap(other); }
  PendingFile& operator=(PendingFile&& other) noexcept {
    swap(other);
    return *this;
  }
  ~PendingFile() { give_up(); }

  const std::filesystem::path& path() const noexcept { return name_; }  ///< until it is published
  int descriptor() const noexcept { return descriptor_; }               ///< open for writing
  bool pending() const noexcept { return descriptor_ >= 0; }  ///< neither published nor given up

  /// Let the disk begin to take what was written, so that publish() waits for little of a large file.
  void start_writing_back() const noexcept;
  /// fsync, rename, fsync the folder; where it need only outlast the process nothing waits for the disk.
  /// Errors: cannot_create (rename), io.
  Result<void> publish(Outlasts end = Outlasts::power_failure);
  /// Give back the space behind so many bytes, where that is possible.
  void shrink(std::uint64_t bytes) noexcept;
  /// Write no more. A temporary file is removed and its space given back, even while something else
  /// holds it open.
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

/// Remove the temporary files of a target that nobody is writing now: of processes that died.
void remove_pending_files(const std::filesystem::path& target) noexcept;

/// Write bytes as a PendingFile and publish it. Errors: cannot_create, io.
Result<void> publish_file(const std::filesystem::path& file, std::span<const std::byte> bytes);

/// Create a folder, and those above it, where they are not there yet. Errors: cannot_create.
Result<void> make_folder(const std::filesystem::path& folder);

/// A checksum of 128 bits by XXH3.
struct Xxh3 {
  std::uint64_t high = 0, low = 0;

  bool operator==(const Xxh3&) const = default;
  std::string hex() const;  ///< 32 hexadecimal digits, high half first
  /// Of 32 such digits; nothing for another text.
  static std::optional<Xxh3> parse(std::string_view hex);
};
/// The checksum of bytes.
Xxh3 xxh3(std::span<const std::byte> bytes) noexcept;
/// The same of bytes of a mapping, of which no more than 16 MiB are in memory at a time.
Xxh3 xxh3_of_mapped(std::span<const std::byte> bytes);

/// XXH3-128 as 32 hexadecimal digits.
inline std::string xxh3_hex(std::span<const std::byte> bytes) { return xxh3(bytes).hex(); }

}  // namespace trivet
