/// What every reader of a format is given, and the words in which it refuses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "storage/common/result.hpp"
#include "storage/data/read_options.hpp"

namespace trivet::formats {

/// A whole file of geometry, untrusted. A reader turns it into a cloud whose indices are in range;
/// its values may still be non-finite.
struct Input {
  const std::filesystem::path& file;  ///< named in errors
  std::span<const std::byte> bytes;
  const ReadOptions& options;
  /// Below which files may be read that this one names; absent: none may, as of bytes that a client
  /// sent.
  std::optional<std::filesystem::path> folder{};

  std::string_view text() const noexcept {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  }
  /// Points are indexed by std::int32_t in pixel grids.
  std::uint64_t max_points() const noexcept {
    return std::min<std::uint64_t>(options.max_points, std::numeric_limits<std::int32_t>::max());
  }

  /// bad_data: "FILE: what", "FILE, line 12: what" (counted from 1).
  Error refuse(std::string_view what) const;
  Error refuse_line(std::size_t line, std::string_view what) const;
  /// "FILE, byte 120: what", counted from 0.
  Error refuse_byte(std::uint64_t byte, std::string_view what) const;
  /// The refusal of more points than allowed.
  Error refuse_count(std::uint64_t num_points) const;
};

/// A piece of the file for an error message: in quotes, shortened, unprintable bytes replaced.
std::string quote(std::string_view text);
/// The same of a word of text; an empty one stands for "the end of the line".
std::string quote_word(std::string_view word);

}  // namespace trivet::formats
