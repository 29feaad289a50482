/// What a file is by its first bytes, for the message that refuses it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace trivet::formats {

struct Appearance {
  std::string_view what;       ///< "an HTML page"; empty when it looks like nothing known
  std::string_view advice;     ///< what to do about it, may be empty
  std::string_view extension;  ///< of the files that ought to look so, ".ply"; may be empty

  explicit operator bool() const noexcept { return !what.empty(); }
};

/// Tell what is often found where something else is expected: pages, pointers, archives, pictures,
/// text of another encoding, other formats of geometry. Reads the first few hundred bytes, and all
/// of a file of zeros or blanks.
Appearance looks_like(std::span<const std::byte> bytes) noexcept;

}  // namespace trivet::formats
