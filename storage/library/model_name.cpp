#include "storage/library/model_name.hpp"

#include <utf8proc.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <memory>

#include "storage/common/valid_text.hpp"
#include "storage/files/text.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet {
namespace {

using formats::is_alphanumeric;

constexpr std::size_t kLongest = 128;

bool is_ascii(char c) noexcept { return static_cast<unsigned char>(c) < 0x80; }
bool is_mark(char c) noexcept { return c == '.' || c == '_' || c == '-'; }

/// The first character of non-empty, well-formed UTF-8.
std::string_view first_character(std::string_view text) noexcept {
  const auto lead = static_cast<unsigned char>(text.front());
  return text.substr(0, lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4);
}

char32_t code_point_of(std::string_view character) noexcept {
  const auto lead = static_cast<unsigned char>(character.front());
  char32_t code = character.size() == 1 ? lead : lead & (0x7FU >> character.size());
  for (const char c : character.substr(1))
    code = code << 6U | (static_cast<unsigned char>(c) & 0x3FU);
  return code;
}

/// Whether a character beyond ASCII is invisible: blanks, word joiners, tags, noncharacters.
bool is_invisible(char32_t c) noexcept {
  constexpr std::array<std::array<char32_t, 2>, 12> kInvisible{{{0xA0, 0xA0},
                                                                {0xAD, 0xAD},
                                                                {0x1680, 0x1680},
                                                                {0x2000, 0x200B},
                                                                {0x202F, 0x202F},
                                                                {0x205F, 0x2065},
                                                                {0x3000, 0x3000},
                                                                {0x3164, 0x3164},
                                                                {0xFDD0, 0xFDEF},
                                                                {0xFEFF, 0xFEFF},
                                                                {0xFFF0, 0xFFFF},
                                                                {0xE0000, 0x10FFFF}}};
  return std::ranges::any_of(kInvisible, [&](const auto& r) { return c >= r[0] && c <= r[1]; });
}

/// Pre: well-formed UTF-8.
bool is_allowed(std::string_view character) {
  const char first = character.front();
  if (is_ascii(first)) return is_alphanumeric(first) || is_mark(first);
  return !is_invisible(code_point_of(character)) && printable(character) == character;
}

/// The text in Unicode normal form C, with each letter and its accents as one character: macOS
/// decomposes them in file names.
std::string composed(const std::string& text) {
  const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> form(
      utf8proc_NFC(reinterpret_cast<const utf8proc_uint8_t*>(text.c_str())), &std::free);
  return form ? reinterpret_cast<const char*>(form.get()) : text;
}

}  // namespace

bool is_model_name(std::string_view name) {
  if (name.empty() || name.size() > kLongest || is_mark(name.front())) return false;
  if (name.find("..") != std::string_view::npos || !is_utf8(name)) return false;
  while (!name.empty()) {
    const std::string_view character = first_character(name);
    if (!is_allowed(character)) return false;
    name.remove_prefix(character.size());
  }
  return true;
}

std::string model_name_of(const std::filesystem::path& file) {
  const std::string stem = composed(valid_utf8(cloud_name(file)));
  if (is_model_name(stem)) return stem;
  std::string name;
  bool replaced = false;  // the last character was replaced
  for (std::string_view rest = stem; !rest.empty();) {
    const std::string_view character = first_character(rest);
    rest.remove_prefix(character.size());
    const bool allowed = is_allowed(character);
    const bool repeats = allowed ? character == "." && name.ends_with('.') : replaced;
    replaced = !allowed;
    const bool begins = !name.empty() || (allowed && !is_mark(character.front()));
    if (repeats || !begins) continue;
    const std::string_view added = allowed ? character : "_";
    if (name.size() + added.size() > kLongest) break;
    name += added;
  }
  while (!name.empty() && is_mark(name.back())) name.pop_back();
  return name.empty() ? "model" : name;
}

}  // namespace trivet
