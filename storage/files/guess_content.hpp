/// Guess of a file's type from its first bytes, for the message that refuses it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace trivet::formats {

struct ContentGuess {
  std::string_view what;       ///< "an HTML page"; empty for an unknown type
  std::string_view advice;     ///< advice for the user, may be empty
  std::string_view extension;  ///< extension that fits the type, ".ply"; may be empty

  explicit operator bool() const noexcept { return !what.empty(); }
};

/// Recognize frequent wrong inputs: web pages, pointer files, archives, pictures, text in another
/// encoding, other geometry formats. Reads the first few hundred bytes, and all of a file of zeros
/// or blanks.
ContentGuess guess_content(std::span<const std::byte> bytes) noexcept;

}  // namespace trivet::formats
