#include "apps/route/merge_answers.hpp"

#include <algorithm>

#include "apps/claims_json.hpp"
#include "engine/merge_claims.hpp"
#include "storage/json_file.hpp"

namespace trivet::apps {
namespace {

using Json = nlohmann::json;

void check_numbers(const JsonNode& node) {
  for (const auto& [key, value] : node.members()) value.number();
}

ShardScene parse_scene(const JsonNode& node) {
  ShardScene scene;
  for (const JsonNode& detection : node.at("detections").elements()) {
    scene.scores.push_back(detection.at("score").number());
    scene.detections.push_back(detection.value());
  }
  check_numbers(node.at("seconds"));
  check_numbers(node.at("counts"));
  scene.claims = parse_claims(node.at("claims"), scene.detections.size());
  scene.json = node.value();
  scene.json.erase("claims");
  scene.json.erase("detections");
  return scene;
}

/// Take the larger of each number.
void take_slower(const Json& other, Json& seconds) {
  for (const auto& [key, value] : other.items()) {
    Json& mine = seconds[key];
    if (mine.is_null() || mine < value) mine = value;
  }
}

void add_counts(const Json& other, Json& counts) {
  for (const auto& [key, value] : other.items())
    counts[key] = counts.value(key, 0.0) + value.get<double>();
}

Json merge_scenes(std::span<const ShardAnswer> answers, std::size_t index) {
  Json merged = answers.front().scenes[index].json;
  std::vector<SceneClaims> claims;
  for (const ShardAnswer& answer : answers) claims.push_back(answer.scenes[index].claims);
  for (const ShardAnswer& answer : answers.subspan(1)) {
    take_slower(answer.scenes[index].json["seconds"], merged["seconds"]);
    add_counts(answer.scenes[index].json["counts"], merged["counts"]);
  }
  std::vector<DetectionPlace> places = *merge_claims(claims);
  const auto score = [&](const DetectionPlace& place) {
    return answers[place.library].scenes[index].scores[place.detection];
  };
  std::ranges::stable_sort(places, [&](const DetectionPlace& a, const DetectionPlace& b) {
    return score(a) > score(b);
  });
  merged["detections"] = Json::array();
  for (const auto& [shard, detection] : places)
    merged["detections"].push_back(answers[shard].scenes[index].detections[detection]);
  return merged;
}

}  // namespace

Result<ShardAnswer> parse_answer(const std::string& shard, const std::string& body) {
  ShardAnswer answer;
  answer.shard = shard;
  const Result<void> done =
      with_json(std::as_bytes(std::span(body)), "its answer", [&](const JsonNode& root) {
        answer.library = root.at("library").object().value();
        check_numbers(root.at("seconds"));
        answer.seconds = root.at("seconds").value();
        for (const JsonNode& scene : root.at("scenes").elements())
          answer.scenes.push_back(parse_scene(scene));
      });
  if (!done) return done.error();
  return answer;
}

bool is_of_same_scenes(const ShardAnswer& a, const ShardAnswer& b) {
  return std::ranges::equal(a.scenes, b.scenes, [](const ShardScene& x, const ShardScene& y) {
    return x.claims.images == y.claims.images;
  });
}

nlohmann::ordered_json merge_answers(std::span<const ShardAnswer> answers) {
  nlohmann::ordered_json libraries = nlohmann::ordered_json::array();
  nlohmann::ordered_json scenes = nlohmann::ordered_json::array();
  Json seconds = answers.front().seconds;
  for (const ShardAnswer& answer : answers) {
    nlohmann::ordered_json library{{"shard", answer.shard}};
    for (const auto& [key, value] : answer.library.items()) library[key] = value;
    libraries.push_back(std::move(library));
    take_slower(answer.seconds, seconds);
  }
  for (std::size_t s = 0; s < answers.front().scenes.size(); ++s)
    scenes.push_back(nlohmann::ordered_json(merge_scenes(answers, s)));
  return {{"libraries", std::move(libraries)},
          {"seconds", std::move(seconds)},
          {"scenes", std::move(scenes)}};
}

}  // namespace trivet::apps
