/// Keeps a process alive when a file that it has mapped is truncated.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

namespace trivet {

/// What the pages of a piece of a mapping are.
enum class PieceState : std::uint8_t {
  of_file,       ///< pages of the file
  being_copied,  ///< pages of the file, which a thread is copying
  copied,        ///< a copy in memory, which no change of the file reaches
  torn,          ///< pages of the file, or zeros from some page on
};

/// While this lives, unreadable pages of a mapping become zeros instead of ending the process
/// (SIGBUS), and the mapping is marked as torn. Pages are unreadable if the file was truncated or
/// its disk failed. Copied pieces stay.
///
/// The first guard installs the signal handler in any process: a library must not be able to end a
/// program that only reads it. The handler changes only pages of guarded mappings. For any other
/// address the previous handler is called, or the process ends as it would have.
class MappingGuard {
 public:
  static constexpr std::size_t kPieceBytes = std::size_t{1} << 20U;  ///< a multiple of any page

  MappingGuard() = default;
  /// The number of guarded mappings is limited to some thousands at a time; further ones are not
  /// guarded.
  ///
  /// mapped  begins with a page
  /// pieces  state of each `kPieceBytes`, the last of which may be shorter; outlives the guard
  MappingGuard(std::span<const std::byte> mapped, std::span<std::atomic<PieceState>> pieces);
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
