#include "apps/service/http/query.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <sstream>

#include "storage/files/text.hpp"
#include "storage/valid_text.hpp"

namespace trivet::apps::service {
namespace {

Result<std::string> decode(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i];
      continue;
    }
    unsigned value = 0;
    const std::string_view digits = text.substr(i + 1, 2);
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16).ptr;
    if (digits.size() < 2 || end != digits.data() + 2) {
      return Error{ErrorCode::usage,
                   fmt::format("expected two hexadecimal digits after '%', found '{}'", digits)};
    }
    out += static_cast<char>(value);
    i += 2;
  }
  if (!is_utf8(out)) {
    return Error{ErrorCode::usage, fmt::format("expected UTF-8 in the target, found '{}'", text)};
  }
  return out;
}

std::string encode(std::string_view text, std::string_view also_plain = "") {
  std::string out;
  for (const char c : text) {
    const bool is_plain = formats::is_alphanumeric(c) ||
                          std::string_view("-._~").find(c) != std::string_view::npos ||
                          also_plain.find(c) != std::string_view::npos;
    out += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace

std::optional<std::string> Target::parameter(std::string_view name) const {
  for (const auto& [key, value] : parameters) {
    if (key == name) return value;
  }
  return std::nullopt;
}

Result<std::string> origin_form(std::string_view target) {
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
    return path;
  }
  return std::string(target);
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

std::string write_target(const Target& target) {
  std::string out = encode(target.path, "/");
  char mark = '?';
  for (const auto& [key, value] : target.parameters) {
    out += mark + encode(key) + "=" + encode(value, ",");
    mark = '&';
  }
  return out;
}

}  // namespace trivet::apps::service
