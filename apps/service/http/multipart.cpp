#include "apps/service/http/multipart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "storage/files/text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::string_view kForm = "multipart/form-data";
constexpr std::size_t kMaxParts = 1000, kMaxHeaderBytes = 4096;

bool begins_with(std::string_view text, std::string_view front) {  // ignores case
  return text.size() >= front.size() &&
         formats::lower_case(text.substr(0, front.size())) == formats::lower_case(front);
}

/// The value of `key="value"` or `key=value` among parameters separated by semicolons.
std::optional<std::string> parameter(std::string_view header, std::string_view key) {
  std::size_t at = header.find(';');
  while (at != std::string_view::npos) {
    std::string_view rest = header.substr(at + 1);
    rest.remove_prefix(std::min(rest.find_first_not_of(" \t"), rest.size()));
    const bool is_it =
        begins_with(rest, key) && rest.size() > key.size() && rest[key.size()] == '=';
    const std::size_t equals = rest.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    rest.remove_prefix(equals + 1);
    std::string value;
    std::size_t end = 0;
    if (!rest.empty() && rest.front() == '"') {
      for (end = 1; end < rest.size() && rest[end] != '"'; ++end) {
        if (rest[end] == '\\' && end + 1 < rest.size()) ++end;
        value += rest[end];
      }
    } else {
      end = std::min(rest.find(';'), rest.size());
      value = rest.substr(0, end);
    }
    if (is_it) return value;
    const std::size_t next = rest.find(';', std::min(end, rest.size()));
    at = next == std::string_view::npos
             ? next
             : static_cast<std::size_t>(rest.data() - header.data()) + next;
  }
  return std::nullopt;
}

/// Reads the header lines of a part.
Result<FormPart> read_part(std::string_view text, std::size_t place) {
  const std::size_t end = text.find("\r\n\r\n");
  if (end == std::string_view::npos || end > kMaxHeaderBytes) {
    return Error{ErrorCode::bad_data,
                 fmt::format("form: byte {}: expected headers and an empty line", place)};
  }
  std::string_view headers = text.substr(0, end);
  FormPart part{"", "", text.substr(end + 4)};
  while (!headers.empty()) {
    const std::string_view line = headers.substr(0, headers.find("\r\n"));
    headers.remove_prefix(std::min(line.size() + 2, headers.size()));
    if (!begins_with(line, "content-disposition:")) continue;
    part.name = parameter(line, "name").value_or("");
    part.file_name = parameter(line, "filename").value_or("");
  }
  if (part.name.empty()) {
    return Error{
        ErrorCode::bad_data,
        fmt::format("form: byte {}: expected Content-Disposition: form-data; name=…", place)};
  }
  return part;
}

}  // namespace

bool is_form(std::string_view content_type) { return begins_with(content_type, kForm); }

Result<std::vector<FormPart>> split_form(std::string_view content_type, std::string_view body) {
  const std::optional<std::string> boundary = parameter(content_type, "boundary");
  if (!boundary || boundary->empty() || boundary->size() > 70) {
    return Error{ErrorCode::bad_data,
                 "Content-Type: expected a boundary of 1 to 70 characters behind " +
                     std::string(kForm) + ";"};
  }
  const std::string delimiter = "--" + *boundary;
  if (!body.starts_with(delimiter)) {
    return Error{ErrorCode::bad_data,
                 fmt::format("form: expected the boundary '{}' at the front", delimiter)};
  }
  std::vector<FormPart> parts;
  std::size_t at = delimiter.size();
  while (body.substr(at, 2) != "--") {
    const std::size_t end = body.find("\r\n" + delimiter, at);
    if (body.substr(at, 2) != "\r\n" || end == std::string_view::npos) {
      return Error{ErrorCode::bad_data,
                   fmt::format("form: byte {}: expected a part that ends with the boundary", at)};
    }
    if (parts.size() == kMaxParts)
      return Error{ErrorCode::bad_data, fmt::format("form: expected at most {} parts", kMaxParts)};
    const std::size_t begin = at + 2;  // after `end` if another boundary follows
    Result<FormPart> part = read_part(body.substr(begin, std::max(end, begin) - begin), begin);
    if (!part) return part.error();
    parts.push_back(std::move(*part));
    at = end + 2 + delimiter.size();
  }
  return parts;
}

}  // namespace trivet::apps::service
