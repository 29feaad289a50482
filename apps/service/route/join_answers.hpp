/// What shards answered, as one answer.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/service/http/http_server.hpp"
#include "apps/service/route/ask_shards.hpp"

namespace trivet::apps::service {

/// Why an answer lacks what a shard holds.
struct Missing {
  std::string shard, reason;
  bool is_late = false;
};

/// [{"shard", "reason"}, …]
nlohmann::ordered_json missing_json(const std::vector<Missing>& missing);

/// 200 with what was found and what is missing; what the shards said where all refuse the request;
/// 503 or, where all were late, 504. Takes the answers of `calls`.
HttpResponse join_answers(std::vector<ShardCall>& calls, std::vector<Missing> missing,
                          const std::string& id);

}  // namespace trivet::apps::service
