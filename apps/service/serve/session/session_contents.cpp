#include "apps/service/serve/session/session_contents.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/results/detections_json.hpp"
#include "storage/files/file.hpp"
#include "storage/files/json_file.hpp"
#include "storage/files/json_text.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint64_t kLeastFileBytes = 4096;  ///< smallest space of a file on a disk

}  // namespace

std::uint64_t bytes_on_disk(std::uint64_t bytes) { return std::max(bytes, kLeastFileBytes); }

std::uint64_t bytes_on_disk(const SessionContents& contents) {
  std::uint64_t sum = 0;
  for (const auto& [file, bytes] : contents.files) sum += bytes_on_disk(bytes);
  return sum;
}

Result<SessionAnswer> read_answer(std::span<const std::byte> bytes, const std::string& name) {
  SessionAnswer answer;
  answer.version = version_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const Result<void> read = with_json(bytes, name, [&](const JsonNode& root) {
    const std::vector<JsonNode> scenes = root.at("scenes").elements();
    if (scenes.size() != 1) root.at("scenes").refuse("expected one scene");
    for (const JsonNode& detection : scenes[0].at("detections").elements()) {
      answer.models.insert(detection.at("model").string());
      detection.at("score").number();
      detection.at("T_scene_model").file_pose();
      if (detection.has("right")) detection.at("right").boolean();
      ++answer.num_found;
    }
    if (root.has("seconds")) answer.seconds = root.at("seconds").at("work").number();
  });
  if (!read) return read.error();
  return answer;
}

nlohmann::ordered_json truth_json(const SessionScan& scan) {
  nlohmann::ordered_json truth;
  if (scan.is_marked) truth = nlohmann::ordered_json::array();
  for (const TruthInstance& instance : scan.listed.truth) {
    truth.push_back(
        {{"model", instance.model}, {"T_scene_model", matrix_json(instance.file_pose())}});
  }
  return truth;
}

std::string version_of(std::string_view bytes) {
  return fmt::format("\"{}\"", xxh3_hex(std::as_bytes(std::span(bytes))));
}

std::string truth_version(const SessionScan& scan) {
  return version_of(json_text(truth_json(scan)));
}

bool expects_version(std::string_view expected, std::string_view version) {
  return expected.empty() || expected == "*" || expected.find(version) != std::string_view::npos;
}

}  // namespace trivet::apps::service
