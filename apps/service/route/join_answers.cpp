#include "apps/service/route/join_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "apps/service/http/http_messages.hpp"
#include "apps/service/route/merge_answers.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::service {
namespace {

using Json = nlohmann::ordered_json;

/// What a refusal says.
std::string reason_of(const HttpResponse& refusal) {
  const Json body = parse_json<Json>(refusal.body);
  const bool is_told = body.is_object() && body.contains("error") && body["error"].is_string();
  return fmt::format("{}{}", refusal.status,
                     is_told ? ": " + body["error"].get<std::string>() : "");
}

HttpResponse nothing_found(const std::vector<Missing>& missing) {
  const bool is_late =
      !missing.empty() && std::ranges::all_of(missing, [](const Missing& m) { return m.is_late; });
  HttpResponse response = json_response(
      is_late ? 504 : 503, {{"error", "no shard answered"}, {"missing", missing_json(missing)}});
  if (!is_late) response.headers.emplace_back("Retry-After", "1");
  return response;
}

}  // namespace

Json missing_json(const std::vector<Missing>& missing) {
  Json json = Json::array();
  for (const Missing& one : missing) json.push_back({{"shard", one.shard}, {"reason", one.reason}});
  return json;
}

HttpResponse join_answers(std::vector<ShardCall>& calls, std::vector<Missing> missing,
                          const std::string& id) {
  std::vector<ShardAnswer> answers;
  std::size_t num_bad_requests = 0;
  for (ShardCall& call : calls) {
    const std::string& name = call.shard->address.name;
    if (const HttpFailure* const failure = std::get_if<HttpFailure>(&call.outcome)) {
      missing.push_back({name, failure->reason, failure->fault == HttpFault::too_late});
    } else if (!call.answer) {
      const HttpResponse& refusal = std::get<HttpResponse>(call.outcome);
      num_bad_requests += refusal.status / 100 == 4 ? 1 : 0;
      missing.push_back({name, reason_of(refusal), refusal.status == 504});
    } else if (!answers.empty() && !is_of_same_scenes(answers.front(), *call.answer)) {
      missing.push_back(
          {name, fmt::format("its scenes have not the sizes of those of {}", answers[0].shard)});
    } else {
      answers.push_back(std::move(*call.answer));
    }
  }
  if (!calls.empty() && num_bad_requests == missing.size() && answers.empty())
    return std::get<HttpResponse>(calls.front().outcome);
  if (answers.empty()) return nothing_found(missing);
  Json json{{"request_id", id}, {"partial", !missing.empty()}, {"missing", missing_json(missing)}};
  json.update(merge_answers(answers));
  return json_response(200, json);
}

}  // namespace trivet::apps::service
