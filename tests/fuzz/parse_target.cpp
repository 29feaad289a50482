// The path and query parameters of a request.
#include <algorithm>

#include "apps/service/http/query.hpp"
#include "fuzz/targets.hpp"
#include "storage/common/valid_text.hpp"

namespace trivet::fuzz {

void parse_target(std::string_view input) {
  const Result<apps::service::HostedTarget> origin = apps::service::origin_form(input);
  require(
      !origin || (origin->host.empty() ? origin->target == input : origin->target.starts_with('/')),
      "what names a host asks for a path of it");
  const Result<apps::service::Target> target = apps::service::parse_target(input);
  if (!target) return require(target.error().code == ErrorCode::usage, "faults are the client's");
  const std::string_view path = input.substr(0, input.find('?'));
  if (apps::service::check_path(input)) {
    require(std::ranges::count(path, '/') == std::ranges::count(target->path, '/'),
            "a path that may be asked for has no hidden slash");
    require(path.find('%') != path.npos || path == target->path, "without escapes it is as it was");
  }
  for (const auto& [name, value] : target->parameters)
    require(target->parameter(name).has_value() && is_utf8(name) && is_utf8(value),
            "a parameter is text, and found by its name");
  const Result<apps::service::Target> again =
      apps::service::parse_target(apps::service::encode_path(target->path));
  require(again.has_value() && again->path == target->path && again->parameters.empty(),
          "a path that was read can be written");
}

std::vector<std::string> parse_target_seeds() {
  return {"/v1/models",
          "/v1/recognize?format=ply&models=a%2Fb,c&min-score=0.5",
          "/?a&=&b=c=d&&",
          "/v1/models/a%20b%C3%A4%25/mesh.ply",
          "/%2e%2e/%00?%7f=%C3%A4#here",
          "/?a=%ff",
          "http://host:80/v2/models/..%2f..?q=1+2"};
}

}  // namespace trivet::fuzz
