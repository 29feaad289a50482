/// Any bytes as text that may be shown: names of files and words of others are bytes.
#pragma once

#include <string>
#include <string_view>

namespace trivet {

/// Whether the bytes are UTF-8 (RFC 3629): no overlong form, no surrogate, nothing cut off.
bool is_utf8(std::string_view bytes) noexcept;

/// The bytes as UTF-8. Each longest part that begins as a character and goes on as none becomes
/// U+FFFD, as the Unicode Standard recommends (3.9, "substitution of maximal subparts").
std::string valid_utf8(std::string_view bytes);

/// The same as one line that does nothing to a terminal or a log: control characters (C0, DEL, C1),
/// breaks of lines and paragraphs, and the marks that reorder text are escaped as in JSON, such as
/// ESC by u001B behind a backslash. Backslashes stay single.
std::string printable(std::string_view bytes);

/// The same of text of several lines: line feeds and tabs stay.
std::string printable_lines(std::string_view bytes);

}  // namespace trivet
