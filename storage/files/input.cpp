#include "storage/files/input.hpp"

#include <fmt/format.h>

namespace trivet::formats {

Error Input::refuse(std::string_view what) const {
  return {ErrorCode::bad_data, fmt::format("{}: {}", file.string(), what)};
}

Error Input::refuse_line(std::size_t line, std::string_view what) const {
  return {ErrorCode::bad_data, fmt::format("{}, line {}: {}", file.string(), line, what)};
}

Error Input::refuse_byte(std::uint64_t byte, std::string_view what) const {
  return {ErrorCode::bad_data, fmt::format("{}, byte {}: {}", file.string(), byte, what)};
}

Error Input::refuse_count(std::uint64_t num_points) const {
  return refuse(
      fmt::format("holds {} points, more than the limit of {}", num_points, max_points()));
}

std::string quote(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out = "\"";
  for (const char c : text.substr(0, kLongest)) out += c >= ' ' && c <= '~' ? c : '?';
  out += text.size() > kLongest ? "...\"" : "\"";
  return out;
}

std::string quote_word(std::string_view word) {
  return word.empty() ? "the end of the line" : quote(word);
}

}  // namespace trivet::formats
