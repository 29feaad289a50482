/// Common input of all format readers, and their error messages.
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

/// A whole geometry file, untrusted. A reader turns it into a cloud whose indices are in range; its
/// values may still be non-finite.
struct Input {
  const std::filesystem::path& file;  ///< named in errors
  std::span<const std::byte> bytes;
  const ReadOptions& options;
  /// Folder below which the file may refer to other files. Absent: no other file may be read, as
  /// for bytes from a client.
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
  /// Error for more points than allowed.
  Error refuse_count(std::uint64_t num_points) const;
};

/// A piece of the file for an error message: quoted, shortened, unprintable bytes replaced.
std::string quote(std::string_view text);
/// As quote(), for a word of text; an empty one stands for "the end of the line".
std::string quote_word(std::string_view word);

}  // namespace trivet::formats
