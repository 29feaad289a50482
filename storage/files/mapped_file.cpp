#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <atomic>
#include <cerrno>

#include "storage/files/descriptor.hpp"
#include "storage/files/errno_text.hpp"
#include "storage/files/file.hpp"
#include "storage/files/mapping_guard.hpp"

namespace trivet {

struct MappedFile::Mapping {
  explicit Mapping(std::span<const std::byte> bytes) : mapped(bytes), guard(bytes) {}
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ~Mapping() { ::munmap(const_cast<std::byte*>(mapped.data()), mapped.size()); }

  const std::span<const std::byte> mapped;
  const MappingGuard guard;
  Descriptor descriptor{};  ///< empty: no other process writes the file
  FileIdentity identity{};  ///< identity at opening
  std::atomic<std::int64_t> touched{0};
  std::atomic<bool> is_changed{false};
};

namespace {

Result<void*> map(const std::filesystem::path& file, const OpenedFile& opened) {
  void* const memory =
      ::mmap(nullptr, opened.identity.size, PROT_READ, MAP_PRIVATE, opened.descriptor.get(), 0);
  if (memory != MAP_FAILED) return memory;
  return Error{ErrorCode::io, fmt::format("{}: cannot be mapped: {}", file.string(), errno_text())};
}

}  // namespace

Result<MappedFile> MappedFile::open(const std::filesystem::path& file, std::uint64_t max_bytes,
                                    Writers writers) {
  TRIVET_TRY_ASSIGN(OpenedFile opened, open_regular(file, max_bytes));
  if (writers == Writers::others && !wait_for_rest(opened)) {
    return Error{ErrorCode::changed,
                 fmt::format("{}: is being written; wait until it is complete", file.string())};
  }
  MappedFile out;
  if (opened.identity.size == 0) return out;
  TRIVET_TRY_ASSIGN(const void* memory, map(file, opened));
  out.mapping_ = std::make_shared<Mapping>(
      std::span(static_cast<const std::byte*>(memory), opened.identity.size));
  out.mapping_->identity = opened.identity;
  out.mapping_->touched = opened.identity.touched;
  if (writers == Writers::others) out.mapping_->descriptor = std::move(opened.descriptor);
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

bool MappedFile::is_at(const std::filesystem::path& file) const noexcept {
  struct stat status {};
  return !mapping_ || ::stat(file.c_str(), &status) != 0 ||
         FileIdentity::of(status).same_file(mapping_->identity);
}

}  // namespace trivet
