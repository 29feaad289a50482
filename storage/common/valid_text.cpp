#include "storage/common/valid_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace trivet {
namespace {

struct Character {
  std::string_view bytes;              ///< bytes of the character, at least one
  std::optional<char32_t> code_point;  ///< empty: ill-formed
};

/// The first character of a non-empty text, by table 3-7 of the Unicode Standard.
Character first_of(std::string_view text) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  if (lead < 0x80) return {text.substr(0, 1), lead};
  const std::size_t length = lead >= 0xF0 ? 4 : lead >= 0xE0 ? 3 : 2;
  if (lead < 0xC2 || lead > 0xF4) return {text.substr(0, 1), {}};

  // The second byte alone identifies overlong forms, surrogates and values beyond U+10FFFF.
  unsigned char low = 0x80, high = 0xBF;
  if (lead == 0xE0) low = 0xA0;
  if (lead == 0xED) high = 0x9F;
  if (lead == 0xF0) low = 0x90;
  if (lead == 0xF4) high = 0x8F;
  char32_t code_point = lead & (0x7FU >> length);
  for (std::size_t i = 1; i < length; ++i) {
    if (i == text.size() || byte(i) < low || byte(i) > high) return {text.substr(0, i), {}};
    code_point = code_point << 6 | (byte(i) & 0x3FU);
    low = 0x80;
    high = 0xBF;
  }
  return {text.substr(0, length), code_point};
}

/// Whether a character has an effect on the surrounding text instead of a visible form.
bool is_control(char32_t c) noexcept {
  const bool is_break = c == 0x2028 || c == 0x2029;
  const bool reorders = c == 0x061C || c == 0x200E || c == 0x200F || (c >= 0x202A && c <= 0x202E) ||
                        (c >= 0x2066 && c <= 0x2069);
  return c < 0x20 || (c >= 0x7F && c <= 0x9F) || is_break || reorders;
}

std::string escaped(char32_t c) {
  if (c == '\n') return "\\n";
  if (c == '\r') return "\\r";
  if (c == '\t') return "\\t";
  return fmt::format("\\u{:04X}", static_cast<std::uint32_t>(c));
}

/// `keeps` selects the characters to keep, in addition to those of plain ASCII.
template <class Keeps>
std::string rewritten(std::string_view text, Keeps keeps) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const auto plain = static_cast<std::size_t>(
        std::ranges::find_if_not(text, [](char c) { return c >= ' ' && c <= '~'; }) - text.begin());
    out += text.substr(0, plain);
    text.remove_prefix(plain);
    if (text.empty()) break;
    const Character c = first_of(text);
    if (!c.code_point) {
      out += "\xEF\xBF\xBD";
    } else if (keeps(*c.code_point)) {
      out += c.bytes;
    } else {
      out += escaped(*c.code_point);
    }
    text.remove_prefix(c.bytes.size());
  }
  return out;
}

}  // namespace

bool is_utf8(std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const Character c = first_of(bytes);
    if (!c.code_point) return false;
    bytes.remove_prefix(c.bytes.size());
  }
  return true;
}

std::string valid_utf8(std::string_view bytes) {
  return rewritten(bytes, [](char32_t) { return true; });
}

std::string printable(std::string_view bytes) {
  return rewritten(bytes, [](char32_t c) { return !is_control(c); });
}

std::string printable_lines(std::string_view bytes) {
  return rewritten(bytes, [](char32_t c) { return c == '\n' || c == '\t' || !is_control(c); });
}

}  // namespace trivet
