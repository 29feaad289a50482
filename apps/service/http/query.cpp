#include "apps/service/http/query.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "storage/common/valid_text.hpp"
#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::size_t kMaxShownPath = 100;

/// Decodes the escape at the beginning of a text. Errors: usage (it is malformed).
Result<char> unescape(std::string_view text) {
  unsigned value = 0;
  const std::string_view digits = text.substr(1, 2);
  const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16).ptr;
  if (digits.size() < 2 || end != digits.data() + 2) {
    return Error{ErrorCode::usage,
                 fmt::format("expected two hexadecimal digits after '%', found '{}'", digits)};
  }
  return static_cast<char>(value);
}

Result<std::string> decode(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    const Result<char> unescaped = unescape(text.substr(i));
    if (!unescaped) return unescaped.error();
    out += *unescaped;
    i += 2;
  }
  if (!is_utf8(out)) {
    return Error{ErrorCode::usage, fmt::format("expected UTF-8 in the target, found '{}'", text)};
  }
  return out;
}

/// Unreserved characters of RFC 3986, 2.3.
bool is_unreserved(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
         std::string_view("-._~").find(c) != std::string_view::npos;
}

/// Characters that need no escape in a path: pchar of RFC 3986, 3.3.
bool is_plain_in_path(char c) {
  return is_unreserved(c) || std::string_view("!$&'()*+,;=:@").find(c) != std::string_view::npos;
}

}  // namespace

std::optional<std::string> Target::parameter(std::string_view name) const {
  for (const auto& [key, value] : parameters) {
    if (key == name) return value;
  }
  return std::nullopt;
}

Result<HostedTarget> origin_form(std::string_view target) {
  for (const std::string_view scheme : {"http://", "https://"}) {
    if (formats::lower_case(target.substr(0, scheme.size())) != scheme) continue;
    const std::string_view rest = target.substr(scheme.size());
    const std::size_t end = std::min(rest.find_first_of("/?"), rest.size());
    if (end == 0) {
      return Error{ErrorCode::usage,
                   fmt::format("expected a host in the target behind {}, found none", scheme)};
    }
    std::string path(rest.substr(end));
    if (!path.starts_with('/')) path.insert(path.begin(), '/');
    return HostedTarget{std::string(rest.substr(0, end)), std::move(path)};
  }
  return HostedTarget{"", std::string(target)};
}

Result<void> check_path(std::string_view target) {
  const std::string_view path = target.substr(0, target.find('?'));
  const auto refuse = [](std::string_view expected, std::string_view found) -> Result<void> {
    return Error{ErrorCode::usage, fmt::format("path: expected {}, found '{}'", expected, found)};
  };
  if (!path.starts_with('/'))
    return refuse("one that begins with '/'", path.substr(0, kMaxShownPath));
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (path[i] != '%') {
      if (path[i] != '/' && !is_plain_in_path(path[i]))
        return refuse("other characters than those of RFC 3986 escaped", path.substr(i, 1));
      continue;
    }
    const std::string_view escape = path.substr(i, 3);
    const Result<char> unescaped = unescape(escape);
    if (!unescaped) return unescaped.error();
    const char c = *unescaped;
    const auto code = static_cast<unsigned char>(c);
    if (is_unreserved(c)) return refuse("letters, digits and -._~ as they are", escape);
    if (c == '/' || c == '\\' || code < ' ' || code == 0x7F)
      return refuse("no escaped slash, backslash or control character", escape);
    if (c == '%' && unescape(fmt::format("%{}", path.substr(i + 3, 2))))
      return refuse("no escape of an escape", path.substr(i, 5));
    i += 2;
  }
  for (std::size_t begin = 1; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view segment = path.substr(begin, end - begin);
    if (segment.empty() || segment == "." || segment == "..")
      return refuse("names between single slashes", fmt::format("/{}/", segment));
    begin = end + 1;
  }
  return {};
}

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, number);
  return read.ec == std::errc() && read.ptr == end ? std::optional(number) : std::nullopt;
}

Result<Target> parse_target(std::string_view target) {
  const std::size_t mark = target.find('?');
  Result<std::string> path = decode(target.substr(0, mark));
  if (!path) return path.error();
  Target out{std::move(*path), {}};
  const std::string query(mark == std::string_view::npos ? "" : target.substr(mark + 1));
  std::istringstream pairs(query);
  for (std::string pair; std::getline(pairs, pair, '&');) {
    if (pair.empty()) continue;
    const std::size_t equals = std::min(pair.find('='), pair.size());
    Result<std::string> key = decode(pair.substr(0, equals));
    if (!key) return key.error();
    Result<std::string> value = decode(pair.substr(std::min(equals + 1, pair.size())));
    if (!value) return value.error();
    out.parameters.emplace_back(std::move(*key), std::move(*value));
  }
  return out;
}

std::string encode_path(std::string_view path) {
  std::string out;
  for (const char c : path) {
    const bool is_plain = is_unreserved(c) || c == '/';
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace trivet::apps::service
