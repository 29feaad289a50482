/// What keeps a process alive when a file that it has mapped is cut short.
#pragma once

#include <cstddef>
#include <span>

namespace trivet {

/// While this lives, pages of a mapping that cannot be read, since the file was cut short or its disk
/// failed, become zeros instead of the end of the process (SIGBUS), and the mapping is torn.
///
/// The first one installs the handler, in whatever process it is: a library must not be able to end
/// a program that only reads it. It touches nothing but pages of guarded mappings; for any other
/// address the handler that was there before is called, or the process ends as it would have.
class MappingGuard {
 public:
  MappingGuard() = default;
  /// Of more than some thousand mappings at a time the further ones are not guarded.
  explicit MappingGuard(std::span<const std::byte> mapped);
  MappingGuard(const MappingGuard&) = delete;
  MappingGuard& operator=(const MappingGuard&) = delete;
  ~MappingGuard();

  /// Whether pages have become zeros.
  bool is_torn() const noexcept;

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t slot_ = kNone;
};

}  // namespace trivet
