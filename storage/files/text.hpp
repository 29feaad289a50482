/// Words and numbers of text files: bounded, independent of the locale, without copies.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "storage/common/stop.hpp"
#include "storage/files/numbers.hpp"

namespace trivet::formats {

/// Cursor over the words of a text. Lines end with \n or \r\n, or with \r alone if the first line
/// does. A UTF-8 byte-order mark is skipped.
class TextCursor {
 public:
  /// Words are separated by blanks and by any of `more_separators`.
  explicit TextCursor(std::string_view text, std::string_view more_separators = {});

  /// The next word of this line; empty at the end of the line.
  std::string_view word() noexcept;
  /// The next word of this line or a later one; empty at the end of the text.
  std::string_view next_word();
  /// Move to the next line; false if there is none. Regularly checks for a stop request.
  bool next_line();
  /// The rest of this line without its break; the cursor stays.
  std::string_view rest_of_line() const noexcept;

  std::size_t line() const noexcept { return line_; }  ///< counted from 1
  std::size_t position() const noexcept { return static_cast<std::size_t>(at_ - begin_); }
  std::size_t remaining() const noexcept { return static_cast<std::size_t>(end_ - at_); }

 private:
  const char *begin_, *at_, *end_;
  char break_ = '\n';
  std::size_t line_ = 1;
  std::array<bool, 256> separates_{};
  StopCheck check_stop_{1 << 14};  // lines
};

/// Whether c is an ASCII letter or digit.
constexpr bool is_alphanumeric(char c) noexcept {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}

/// The text with ASCII capitals in lower case.
std::string lower_case(std::string_view text);

}  // namespace trivet::formats
