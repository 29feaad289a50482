/// Keeps a process alive when a file that it has mapped is truncated.
#pragma once

#include <cstddef>
#include <span>

namespace trivet {

/// While this lives, unreadable pages of a mapping become zeros instead of ending the process
/// (SIGBUS), and the mapping is marked as torn. Pages are unreadable if the file was truncated or
/// its disk failed.
///
/// The first guard installs the signal handler in any process: a library must not be able to end a
/// program that only reads it. The handler changes only pages of guarded mappings. For any other
/// address the previous handler is called, or the process ends as it would have.
class MappingGuard {
 public:
  MappingGuard() = default;
  /// The number of guarded mappings is limited to some thousands at a time; further ones are not
  /// guarded.
  explicit MappingGuard(std::span<const std::byte> mapped);
  MappingGuard(const MappingGuard&) = delete;
  MappingGuard& operator=(const MappingGuard&) = delete;
  ~MappingGuard();

  /// Whether any page was replaced by zeros.
  bool is_torn() const noexcept;

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t slot_ = kNone;
};

}  // namespace trivet
