/// The target of a request: its path and parameters.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet::apps::service {

/// Names with values as texts, in their order.
using Parameters = std::vector<std::pair<std::string, std::string>>;

struct Target {
  std::string path;
  Parameters parameters;  ///< decoded

  std::optional<std::string> parameter(std::string_view name) const;
};

/// A target with the host that it may name.
struct HostedTarget {
  std::string host;  ///< empty: it names none
  std::string target;
};

/// What a request asks of the host that it names: `http://host/path?query` (RFC 9112, 3.2.2) as
/// `/path?query`, other targets as they are. Errors: usage (no host).
Result<HostedTarget> origin_form(std::string_view target);

/// Whether the path of a target can be read in one way only, so that rules of a proxy for paths as
/// they are sent hold for what is answered. Escapes stand for no letter, digit or -._~, no slash,
/// backslash or control character, and no other escape; no segment is empty, but the last, or all
/// dots. Errors: usage.
Result<void> check_path(std::string_view target);

/// A text of digits only; none: it is something else, or too large.
std::optional<std::size_t> whole_number(std::string_view text);

/// Split and decode (RFC 3986, 2.1; plus signs stay). Errors: usage (a broken
/// escape; what is no UTF-8).
Result<Target> parse_target(std::string_view target);
/// A path as it stands in a target, of which parse_target makes it again.
std::string encode_path(std::string_view path);

}  // namespace trivet::apps::service
