#include "apps/inputs/marked_detections.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "storage/files/json_file.hpp"

namespace trivet::apps {
namespace {

kernels::ScoreParts parse_parts(const JsonNode& node) {
  kernels::ScoreParts parts{};
  for (std::size_t k = 0; k < parts.size(); ++k)
    parts[k] = static_cast<float>(node.at(kernels::kScoreParts[k].name).number());
  return parts;
}

/// The index of a scan. A scan that was recognized twice has one index.
std::uint32_t index_of(const std::string& scan, Outcomes& outcomes) {
  const auto found = std::ranges::find(outcomes.scans, scan);
  const auto index = static_cast<std::uint32_t>(found - outcomes.scans.begin());
  if (found == outcomes.scans.end()) outcomes.scans.push_back(scan);
  return index;
}

}  // namespace

Result<void> add_marked(const std::filesystem::path& file, Outcomes& outcomes) {
  const std::size_t before = outcomes.right.size();
  const Result<void> read = with_json(file, [&](const JsonNode& root) {
    for (const JsonNode& scene : root.at("scenes").elements()) {
      const std::uint32_t scan = index_of(scene.at("scene").string(), outcomes);
      for (const JsonNode& detection : scene.at("detections").elements()) {
        if (!detection.has("right")) continue;
        outcomes.right.push_back(detection.at("right").boolean() ? 1 : 0);
        outcomes.parts.push_back(parse_parts(detection.at("parts")));
        outcomes.scan.push_back(scan);
      }
    }
  });
  if (!read) return read;
  if (outcomes.right.size() > before) return {};
  return Error{
      ErrorCode::bad_data,
      fmt::format("{}: expected detections with \"right\": true or \"right\": false, found "
                  "none; mark them in a result of `trivet recognize --min-score 0.02 "
                  "--json`",
                  file.string())};
}

}  // namespace trivet::apps
