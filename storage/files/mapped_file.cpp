#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>
#include <vector>

#include "storage/files/descriptor.hpp"
#include "storage/files/errno_text.hpp"
#include "storage/files/file.hpp"
#include "storage/files/mapping_guard.hpp"

namespace trivet {

struct MappedFile::Mapping {
  explicit Mapping(std::span<const std::byte> bytes)
      : mapped(bytes),
        pieces((bytes.size() + MappingGuard::kPieceBytes - 1) / MappingGuard::kPieceBytes),
        guard(bytes, pieces) {}
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() { ::munmap(const_cast<std::byte*>(mapped.data()), mapped.size()); }

  std::span<const std::byte> piece(std::size_t k) const noexcept {
    const std::size_t first = k * MappingGuard::kPieceBytes;
    return mapped.subspan(first, std::min(MappingGuard::kPieceBytes, mapped.size() - first));
  }
  Result<void> copy(std::size_t k);

  const std::span<const std::byte> mapped;
  std::vector<std::atomic<PieceState>> pieces;
  const MappingGuard guard;
  Descriptor descriptor{};  ///< empty: no other process writes the file
  Descriptor copies{};      ///< memory with the copied pieces, at their places; empty: none
  FileIdentity identity{};  ///< identity at opening
  std::atomic<std::int64_t> touched{0};
  std::atomic<bool> is_changed{false};
};

namespace {

/// All bytes of a file; null with errno if it cannot be mapped.
const std::byte* map(const Descriptor& file, std::size_t size) {
  void* const memory = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  return memory == MAP_FAILED ? nullptr : static_cast<const std::byte*>(memory);
}

/// Memory that can be mapped as a file, all of it holes. Empty if the system refuses it. Limits on the
/// size of files hold for it, and exceeding them ends a process.
Descriptor memory_for(std::uint64_t bytes) {
  struct rlimit limit {};
  if (::getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur < bytes) return {};
  return Descriptor(::memfd_create("trivet library", MFD_CLOEXEC));
}

Error no_memory_for_copies() {
  return {ErrorCode::no_memory,
          fmt::format("a copy of a mapped file cannot be made: {}", errno_text())};
}

/// Map a piece of a file in place of another mapping.
bool map_over(std::span<const std::byte> mapped, int flags, int descriptor, std::size_t from) {
  return ::mmap(const_cast<std::byte*>(mapped.data()), mapped.size(), PROT_READ, flags | MAP_FIXED,
                descriptor, static_cast<off_t>(from)) != MAP_FAILED;
}

}  // namespace

/// Copy a piece that is being_copied. What the file no longer has are zeros.
Result<void> MappedFile::Mapping::copy(std::size_t k) {
  const std::span<const std::byte> bytes = piece(k);
  const std::size_t from = k * MappingGuard::kPieceBytes;
  const int memory = copies.get();
  if (::fallocate(memory, 0, static_cast<off_t>(from), static_cast<off_t>(bytes.size())) != 0)
    return no_memory_for_copies();
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(memory, bytes.data() + done, bytes.size() - done, static_cast<off_t>(from + done));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EFAULT) break;  // the file has become shorter
    if (written <= 0) return no_memory_for_copies();
    done += static_cast<std::size_t>(written);
  }
  if (!map_over(bytes, MAP_SHARED, memory, from)) return no_memory_for_copies();
  return {};
}

Result<MappedFile> MappedFile::open(const std::filesystem::path& file, std::uint64_t max_bytes,
                                    Writers writers) {
  TRIVET_TRY_ASSIGN(OpenedFile opened, open_regular(file, max_bytes));
  if (writers == Writers::others && !wait_for_rest(opened)) {
    return Error{ErrorCode::changed,
                 fmt::format("{}: is being written; wait until it is complete", file.string())};
  }
  MappedFile out;
  if (opened.identity.size == 0) return out;
  const std::byte* const memory = map(opened.descriptor, opened.identity.size);
  if (memory == nullptr)
    return Error{ErrorCode::io,
                 fmt::format("{}: cannot be mapped: {}", file.string(), errno_text())};
  out.mapping_ = std::make_shared<Mapping>(std::span(memory, opened.identity.size));
  out.mapping_->identity = opened.identity;
  out.mapping_->touched = opened.identity.touched;
  if (writers == Writers::others) {
    out.mapping_->descriptor = std::move(opened.descriptor);
    out.mapping_->copies = memory_for(opened.identity.size);
  }
  return out;
}

std::span<const std::byte> MappedFile::bytes() const noexcept {
  return mapping_ ? mapping_->mapped : std::span<const std::byte>();
}

std::shared_ptr<const std::byte> MappedFile::owner() const noexcept {
  return {mapping_, bytes().data()};
}

MappedFile::State MappedFile::state() const noexcept {
  if (!mapping_) return State::same;
  Mapping& mapping = *mapping_;
  if (mapping.is_changed) return State::changed;
  bool is_touched = false;
  if (mapping.descriptor) {
    struct stat status {};
    const bool is_known = ::fstat(mapping.descriptor.get(), &status) == 0;
    const FileIdentity now = FileIdentity::of(status);
    if (!is_known || !now.same_bytes(mapping.identity)) mapping.is_changed = true;
    is_touched = now.touched != mapping.touched && now.num_names > 0;
  }
  if (mapping.guard.is_torn()) mapping.is_changed = true;
  if (mapping.is_changed) return State::changed;
  return is_touched ? State::touched : State::same;
}

std::int64_t MappedFile::time_of_touch() const noexcept {
  struct stat status {};
  if (!mapping_ || !mapping_->descriptor || ::fstat(mapping_->descriptor.get(), &status) != 0)
    return 0;
  return FileIdentity::of(status).touched;
}

void MappedFile::accept_touch(std::int64_t time) const noexcept {
  if (mapping_) mapping_->touched = time;
}

void MappedFile::condemn() const noexcept {
  if (mapping_) mapping_->is_changed = true;
}

Result<void> MappedFile::copy(std::span<const std::byte> bytes) const {
  if (!has_memory() || bytes.empty()) return {};
  const auto first = static_cast<std::size_t>(bytes.data() - mapping_->mapped.data());
  const std::size_t last = (first + bytes.size() - 1) / MappingGuard::kPieceBytes;
  for (std::size_t k = first / MappingGuard::kPieceBytes; k <= last; ++k) {
    std::atomic<PieceState>& state = mapping_->pieces[k];
    PieceState found = PieceState::of_file;
    if (state.compare_exchange_strong(found, PieceState::being_copied)) {
      const Result<void> copied = mapping_->copy(k);
      state.store(copied ? PieceState::copied : PieceState::of_file, std::memory_order_release);
      state.notify_all();
      if (!copied) return copied.error();
    } else {
      state.wait(PieceState::being_copied, std::memory_order_acquire);
    }
  }
  return {};
}

bool MappedFile::has_memory() const noexcept { return mapping_ && mapping_->copies; }

void MappedFile::drop_copies() const noexcept {
  if (!has_memory()) return;
  for (std::size_t k = 0; k < mapping_->pieces.size(); ++k) {
    const std::size_t from = k * MappingGuard::kPieceBytes;
    if (mapping_->pieces[k] != PieceState::copied ||
        !map_over(mapping_->piece(k), MAP_PRIVATE, mapping_->descriptor.get(), from))
      continue;
    mapping_->pieces[k] = PieceState::of_file;
    (void)::fallocate(mapping_->copies.get(), FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                      static_cast<off_t>(from), static_cast<off_t>(MappingGuard::kPieceBytes));
  }
}

Result<MappedFile> MappedFile::mapped_again() const {
  MappedFile out;
  if (!mapping_ || !mapping_->descriptor) return out;
  const std::byte* const memory = map(mapping_->descriptor, mapping_->mapped.size());
  if (memory == nullptr)
    return Error{ErrorCode::io, fmt::format("a file cannot be mapped again: {}", errno_text())};
  out.mapping_ = std::make_shared<Mapping>(std::span(memory, mapping_->mapped.size()));
  return out;
}

bool MappedFile::is_at(const std::filesystem::path& file) const noexcept {
  struct stat status {};
  return !mapping_ || ::stat(file.c_str(), &status) != 0 ||
         FileIdentity::of(status).same_file(mapping_->identity);
}

}  // namespace trivet
