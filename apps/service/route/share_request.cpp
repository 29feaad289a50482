#include "apps/service/route/share_request.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "apps/service/http/multipart.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {

Result<void> check_form(const HttpRequest& request) {
  const std::string type = request.header("content-type");
  if (!is_form(type)) return {};
  const Result<std::vector<FormPart>> parts = split_form(type, request.body);
  if (!parts) return parts.error();
  for (const FormPart& part : *parts) {
    if (part.name != "options") continue;
    const Result<void> good =
        with_json(std::as_bytes(std::span(part.content)), "options", [](const JsonNode& root) {
          for (const char* const name : {"models", "claims"}) {
            if (root.has(name))
              root.at(name).refuse("expected none behind a router but in the target: ?models=a,b");
          }
        });
    if (!good) return good;
  }
  return {};
}

Result<std::vector<Target>> targets_of(const Target& asked, std::span<const Shard> shards) {
  std::vector<Target> out(shards.size(), asked);
  for (Target& target : out) target.parameters.emplace_back("claims", "true");
  const std::optional<std::string> models = asked.parameter("models");
  if (!models) return out;
  std::vector<std::string> shares(shards.size());
  for (const std::string& name : CLI::detail::split(*models, ',')) {
    bool is_known = false;
    for (std::size_t k = 0; k < shards.size(); ++k) {
      const bool holds = shards[k].catalog && shards[k].catalog->names.contains(name);
      if (!holds && shards[k].catalog) continue;
      is_known = true;  // or may be held by a shard that has not told yet
      shares[k] += (shares[k].empty() ? "" : ",") + name;
    }
    if (!is_known) {
      return Error{ErrorCode::usage,
                   fmt::format("expected a model named '{}', found none; GET /v1/models tells "
                               "the names",
                               name)};
    }
  }
  for (std::size_t k = 0; k < shards.size(); ++k) {
    if (shares[k].empty()) out[k].path.clear();
    for (auto& [name, value] : out[k].parameters) {
      if (name == "models") value = shares[k];
    }
  }
  return out;
}

HttpCall call_of(const Call& call, const Target& target, const Shard& shard,
                 const std::string& token, std::chrono::milliseconds left) {
  HttpCall out{"POST", shard.address.name, write_target(target)};
  out.headers = {{"X-Request-Id", call.id},
                 {"X-Deadline-Ms", std::to_string(std::max<long>(1, left.count()))}};
  for (const auto& [name, value] : {std::pair("Content-Type", call.request.header("content-type")),
                                    std::pair("traceparent", call.trace)}) {
    if (!value.empty()) out.headers.emplace_back(name, value);
  }
  add_token(out, token);
  out.body = std::as_bytes(std::span(call.request.body));
  return out;
}

}  // namespace trivet::apps::service
