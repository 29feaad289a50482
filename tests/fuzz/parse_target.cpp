// The path and parameters of a request.
#include <fmt/format.h>

#include "apps/serve/query.hpp"
#include "fuzz/targets.hpp"

namespace trivet::fuzz {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) out += fmt::format("%{:02x}", static_cast<unsigned char>(c));
  return out;
}

}  // namespace

void parse_target(std::string_view input) {
  const Result<apps::Target> target = apps::parse_target(input);
  if (!target) return require(target.error().code == ErrorCode::usage, "faults are the client's");
  std::string again = escaped(target->path) + "?";
  for (const auto& [name, value] : target->parameters) {
    again += escaped(name) + "=" + escaped(value) + "&";
    require(target->parameter(name).has_value(), "a parameter is found by its name");
  }
  const Result<apps::Target> same = apps::parse_target(again);
  require(same.has_value() && same->path == target->path && same->parameters == target->parameters,
          "what was decoded can be encoded");
}

std::vector<std::string> parse_target_seeds() {
  return {"/v1/models", "/v1/recognize?format=ply&models=a%2Fb,c&min-score=0.5", "/?a&=&b=c=d&&",
          "/%2e%2e/%00?%ff=%C3%A4#here", "http://host:80/v2/models/..%2f..?q=1+2"};
}

}  // namespace trivet::fuzz
