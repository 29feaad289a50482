#include "apps/service/route/merge_answers.hpp"

#include <algorithm>

#include "apps/results/claims_json.hpp"
#include "engine/merge_claims.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps::service {
namespace {

using AnswerJson = nlohmann::json;

void check_numbers(const JsonNode& node) {
  for (const auto& [key, value] : node.members()) value.number();
}

ShardScene parse_scene(const JsonNode& node) {
  ShardScene scene;
  for (const JsonNode& detection : node.at("detections").elements()) {
    detection.at("score").number();
    scene.detections.push_back(detection.value());
  }
  const auto last = static_cast<int>(scene.detections.size()) - 1;
  for (const JsonNode& pose :
       node.has("rejected") ? node.at("rejected").elements() : std::vector<JsonNode>()) {
    pose.at("score").number();
    if (pose.has("explained_by")) pose.at("explained_by").integer(0, last);
    scene.rejected.push_back(pose.value());
  }
  if (node.has("explanation")) {
    for (const JsonNode& of : node.at("explanation").at("models").elements()) {
      of.at("words").string();
      if (of.has("detection")) of.at("detection").integer(0, last);
      if (of.has("pose") && of.at("pose").has("explained_by"))
        of.at("pose").at("explained_by").integer(0, last);
    }
  }
  check_numbers(node.at("seconds"));
  check_numbers(node.at("counts"));
  scene.claims = parse_claims(node.at("claims"), scene.detections.size());
  scene.json = node.value();
  for (const char* const key : {"claims", "detections"}) scene.json.erase(key);
  return scene;
}

/// Take the larger of each number.
void take_slower(const AnswerJson& other, AnswerJson& seconds) {
  for (const auto& [key, value] : other.items()) {
    AnswerJson& mine = seconds[key];
    if (mine.is_null() || mine < value) mine = value;
  }
}

void add_counts(const AnswerJson& other, AnswerJson& counts) {
  for (const auto& [key, value] : other.items())
    counts[key] = counts.value(key, std::uint64_t{0}) + value.get<std::uint64_t>();
}

void sort_by_score(std::vector<AnswerJson>& poses) {
  std::ranges::stable_sort(poses, [](const AnswerJson& a, const AnswerJson& b) {
    return a["score"].get<double>() > b["score"].get<double>();
  });
}

/// Where a detection of a shard stands in the joined answer; null where it does not, or is null.
AnswerJson place_among(std::span<const DetectionPlace> standing, std::size_t shard,
                       const AnswerJson& detection) {
  if (detection.is_null()) return {};
  const auto found =
      std::ranges::find(standing, DetectionPlace{shard, detection.get<std::size_t>()});
  return found == standing.end() ? AnswerJson() : AnswerJson(found - standing.begin());
}

/// The rejected poses of all shards; what explains one is told by its index among `standing`.
std::vector<AnswerJson> merge_rejected(std::span<const ShardAnswer> answers, std::size_t index,
                                       std::span<const DetectionPlace> standing) {
  std::vector<AnswerJson> all;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    for (AnswerJson pose : answers[k].scenes[index].rejected) {
      pose["explained_by"] = place_among(standing, k, pose["explained_by"]);
      all.push_back(std::move(pose));
    }
  }
  sort_by_score(all);
  return all;
}

/// What all shards say of the place that was asked about, those that found something there first.
AnswerJson merge_explanations(std::span<const ShardAnswer> answers, std::size_t index,
                              std::span<const DetectionPlace> standing) {
  std::vector<AnswerJson> all;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    const AnswerJson& scene = answers[k].scenes[index].json;
    if (!scene.contains("explanation")) continue;
    for (AnswerJson of : scene["explanation"]["models"]) {
      const bool was_found = !of["detection"].is_null();
      of["detection"] = place_among(standing, k, of["detection"]);
      if (was_found && of["detection"].is_null())
        of["words"] = "is found here by its shard alone; another model explains the place better";
      if (!of["pose"].is_null())
        of["pose"]["explained_by"] = place_among(standing, k, of["pose"]["explained_by"]);
      all.push_back(std::move(of));
    }
  }
  std::ranges::stable_sort(all, std::ranges::greater(),
                           [](const AnswerJson& of) { return !of["detection"].is_null(); });
  AnswerJson merged = answers.front().scenes[index].json["explanation"];
  merged["models"] = std::move(all);
  return merged;
}

AnswerJson merge_scenes(std::span<const ShardAnswer> answers, std::size_t index) {
  AnswerJson merged = answers.front().scenes[index].json;
  std::vector<SceneClaims> claims;
  for (const ShardAnswer& answer : answers) claims.push_back(answer.scenes[index].claims);
  for (const ShardAnswer& answer : answers.subspan(1)) {
    take_slower(answer.scenes[index].json["seconds"], merged["seconds"]);
    add_counts(answer.scenes[index].json["counts"], merged["counts"]);
  }
  // Each shard checked the camera by its own objects.
  if (answers.size() > 1) merged["camera_check"] = nullptr;
  std::vector<DetectionPlace> standing = *merge_claims(claims);
  const auto detection = [&](const DetectionPlace& place) -> const AnswerJson& {
    return answers[place.library].scenes[index].detections[place.detection];
  };
  std::ranges::stable_sort(standing, [&](const DetectionPlace& a, const DetectionPlace& b) {
    return detection(a)["score"].get<double>() > detection(b)["score"].get<double>();
  });
  merged["detections"] = AnswerJson::array();
  for (const DetectionPlace& place : standing) merged["detections"].push_back(detection(place));
  if (merged.contains("rejected")) merged["rejected"] = merge_rejected(answers, index, standing);
  if (merged.contains("explanation"))
    merged["explanation"] = merge_explanations(answers, index, standing);
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
  AnswerJson seconds = answers.front().seconds;
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

}  // namespace trivet::apps::service
