/// Arbitrary bytes as text that may be displayed: file names and foreign text may hold any bytes.
#pragma once

#include <string>
#include <string_view>

namespace trivet {

/// Whether the bytes are valid UTF-8 (RFC 3629): no overlong form, surrogate or truncated
/// character.
bool is_utf8(std::string_view bytes) noexcept;

/// The bytes as UTF-8. Each maximal prefix of an ill-formed character becomes U+FFFD, as the
/// Unicode Standard recommends (3.9, "substitution of maximal subparts").
std::string valid_utf8(std::string_view bytes);

/// The bytes as one line of UTF-8 without effect on a terminal or a log. Control characters (C0,
/// DEL, C1), line and paragraph separators, and bidirectional marks are escaped as in JSON, such as
/// ESC as u001B after a backslash. Backslashes stay single.
std::string printable(std::string_view bytes);

/// As printable(), for text of several lines: line feeds and tabs stay.
std::string printable_lines(std::string_view bytes);

}  // namespace trivet
