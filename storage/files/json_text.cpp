#include "storage/files/json_text.hpp"

#include <fmt/format.h>

namespace trivet {
namespace {

/// They can stand in strings only, where \u007f means the same.
std::string without_controls(std::string text) {
  constexpr std::string_view kSuspects = "\x7F\xC2";
  std::size_t at = text.find_first_of(kSuspects);
  if (at == text.npos) return text;
  std::string out;
  std::size_t kept = 0;
  for (; at != text.npos; at = text.find_first_of(kSuspects, at + 1)) {
    const bool is_del = text[at] == '\x7F';
    const auto code = static_cast<unsigned char>(is_del ? text[at] : text[at + 1]);
    if (!is_del && code >= 0xA0) continue;  // beyond C1, which are C2 80 to C2 9F
    out.append(text, kept, at - kept).append(fmt::format("\\u{:04x}", unsigned{code}));
    kept = at + (is_del ? 1 : 2);
  }
  return out.append(text, kept);
}

template <class Json>
std::string text_of(const Json& document, int indent) {
  const bool is_pretty = indent >= 0;
  return without_controls(
      document.dump(is_pretty ? indent : -1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

std::string json_text(const nlohmann::json& document, int indent) {
  return text_of(document, indent);
}

std::string json_text(const nlohmann::ordered_json& document, int indent) {
  return text_of(document, indent);
}

}  // namespace trivet
