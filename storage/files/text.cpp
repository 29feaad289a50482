#include "storage/files/text.hpp"

#include <algorithm>

namespace trivet::formats {

TextCursor::TextCursor(std::string_view text, std::string_view more_separators)
    : begin_(text.data()), at_(text.data()), end_(text.data() + text.size()) {
  const std::size_t first_break = text.find_first_of("\r\n");
  if (first_break != text.npos && text[first_break] == '\r' &&
      text.substr(first_break + 1, 1) != "\n") {
    break_ = '\r';
  }
  if (text.starts_with("\xEF\xBB\xBF")) at_ += 3;
  for (const char c : std::string_view(" \t\r\n\v\f"))
    separates_[static_cast<unsigned char>(c)] = c != break_;
  for (const char c : more_separators) separates_[static_cast<unsigned char>(c)] = true;
}

std::string_view TextCursor::word() noexcept {
  while (at_ != end_ && separates_[static_cast<unsigned char>(*at_)]) ++at_;
  const char* const first = at_;
  while (at_ != end_ && *at_ != break_ && !separates_[static_cast<unsigned char>(*at_)]) ++at_;
  return {first, static_cast<std::size_t>(at_ - first)};
}

std::string_view TextCursor::next_word() {
  std::string_view found = word();
  while (found.empty() && next_line()) found = word();
  return found;
}

bool TextCursor::next_line() {
  check_stop_();
  at_ = std::find(at_, end_, break_);
  if (at_ == end_) return false;
  ++at_;
  ++line_;
  return true;
}

std::string_view TextCursor::rest_of_line() const noexcept {
  const char* last = std::find(at_, end_, break_);
  const auto size = static_cast<std::size_t>(last - at_);
  const std::string_view line(at_, size);
  return line.ends_with('\r') ? line.substr(0, size - 1) : line;
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

}  // namespace trivet::formats
