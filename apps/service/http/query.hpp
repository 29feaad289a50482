/// The target of a request: its path and parameters.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Names with text values, in their order.
using Parameters = std::vector<std::pair<std::string, std::string>>;

struct Target {
  std::string path;
  Parameters parameters;  ///< decoded

  std::optional<std::string> parameter(std::string_view name) const;
};

/// A target, and the host that it may name.
struct HostedTarget {
  std::string host;  ///< empty: none named
  std::string target;
};

/// Splits off the host that a target names: `http://host/path?query` (RFC 9112, 3.2.2) becomes
/// `/path?query`. Other targets stay as they are. Errors: usage (no host).
Result<HostedTarget> origin_form(std::string_view target);

/// Whether the path of a target is unambiguous, so that a proxy's rules for paths as they are sent
/// apply to the path that is answered. No escape stands for a letter, a digit, one of -._~, a
/// slash, a backslash or a control character, or begins another escape. No segment consists of
/// dots, and none but the last is empty.
/// Errors: usage.
Result<void> check_path(std::string_view target);

/// Parses a text of digits only; none: another text, or too large a number.
std::optional<std::size_t> whole_number(std::string_view text);

/// Splits and decodes a target (RFC 3986, 2.1; plus signs stay).
/// Errors: usage (a malformed escape, or invalid UTF-8).
Result<Target> parse_target(std::string_view target);
/// Encodes a path for a target; the inverse of parse_target.
std::string encode_path(std::string_view path);

}  // namespace trivet::apps::service
