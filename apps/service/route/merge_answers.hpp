/// One answer of what several shards answered to one request.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "engine/recognize.hpp"
#include "storage/result.hpp"

namespace trivet::apps::service {

/// What a shard found in one scene.
struct ShardScene {
  nlohmann::json json;                               ///< without what follows
  std::vector<nlohmann::json> detections, rejected;  ///< as the shard wrote them
  SceneClaims claims;
};

/// The body of an answer to POST /v1/recognize with the parameter claims, checked.
struct ShardAnswer {
  std::string shard;
  nlohmann::json library, seconds;
  std::vector<ShardScene> scenes;
};

/// Errors: bad_data (names the path of the fault).
Result<ShardAnswer> parse_answer(const std::string& shard, const std::string& body);

/// Whether two answers are about the same scenes, looked at in the same images.
bool is_of_same_scenes(const ShardAnswer& a, const ShardAnswer& b);

/// {"libraries", "seconds", "scenes"}: detections that stand when all shards' poses are selected
/// together, by falling score; rejected poses are those of all shards; seconds are those of the
/// slowest shard, counts those of all. answers  at least one, of the same scenes
nlohmann::ordered_json merge_answers(std::span<const ShardAnswer> answers);

}  // namespace trivet::apps::service
