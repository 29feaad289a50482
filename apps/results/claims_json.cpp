#include "apps/results/claims_json.hpp"

#include <fmt/format.h>

#include <vector>

namespace trivet::apps {
namespace {

constexpr int kMaxPixels = 1 << 26;
constexpr int kMaxSide = 1 << 16;

nlohmann::ordered_json runs_json(const kernels::ExplainedPixels& explained) {
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  const std::vector<std::uint32_t>& pixels = explained.pixels;
  for (std::size_t first = 0; first < pixels.size();) {
    std::size_t next = first + 1;
    while (next < pixels.size() && pixels[next] == pixels[next - 1] + explained.square) ++next;
    runs.push_back(pixels[first]);
    runs.push_back(next - first);
    first = next;
  }
  return runs;
}

/// Pixels are below `num_pixels`; `left` more may be claimed.
kernels::ExplainedPixels parse_runs(const JsonNode& pose, int num_pixels, int& left) {
  kernels::ExplainedPixels explained;
  const int square = pose.at("square").integer(1, kMaxSide);
  explained.square = static_cast<std::uint32_t>(square);
  const std::vector<JsonNode> runs = pose.at("runs").elements();
  if (runs.size() % 2 != 0) pose.at("runs").refuse("expected pairs of numbers");
  for (std::size_t i = 0; i < runs.size(); i += 2) {
    const int first = runs[i].integer(0, num_pixels - 1);
    const int count = runs[i + 1].integer(1, std::min((num_pixels - 1 - first) / square + 1, left));
    left -= count;
    for (int k = 0; k < count; ++k)
      explained.pixels.push_back(static_cast<std::uint32_t>(first + k * square));
  }
  return explained;
}

}  // namespace

nlohmann::ordered_json claims_json(const SceneClaims& claims) {
  nlohmann::ordered_json images = nlohmann::ordered_json::array();
  for (const ImageSize& image : claims.images) images.push_back({image.width, image.height});
  nlohmann::ordered_json poses = nlohmann::ordered_json::array();
  for (const PoseClaim& pose : claims.poses) {
    nlohmann::ordered_json detection;
    if (pose.detection) detection = *pose.detection;
    poses.push_back({{"model", pose.model},
                     {"rank", pose.rank},
                     {"detection", std::move(detection)},
                     {"square", pose.explained.square},
                     {"runs", runs_json(pose.explained)}});
  }
  return {{"images", std::move(images)}, {"poses", std::move(poses)}};
}

SceneClaims parse_claims(const JsonNode& node, std::size_t num_detections) {
  SceneClaims claims;
  int num_pixels = 0, left = kMaxPixels;
  for (const JsonNode& image : node.at("images").elements()) {
    const std::vector<JsonNode> sides = image.elements();
    if (sides.size() != 2) image.refuse("expected a width and a height");
    const int width = sides[0].integer(0, kMaxSide);
    const int height =
        sides[1].integer(0, width == 0 ? kMaxSide : (kMaxPixels - num_pixels) / width);
    num_pixels += width * height;
    claims.images.push_back(
        {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)});
  }
  std::vector<bool> is_claimed(num_detections, false);
  for (const JsonNode& pose : node.at("poses").elements()) {
    PoseClaim claim{pose.at("model").string(),
                    static_cast<float>(pose.at("rank").number()),
                    parse_runs(pose, num_pixels, left),
                    {}};
    if (pose.has("detection")) {
      const auto last = static_cast<int>(num_detections) - 1;
      const int detection = pose.at("detection").integer(0, last);
      if (is_claimed[static_cast<std::size_t>(detection)])
        pose.at("detection").refuse("expected each detection once");
      is_claimed[static_cast<std::size_t>(detection)] = true;
      claim.detection = static_cast<std::size_t>(detection);
    }
    claims.poses.push_back(std::move(claim));
  }
  for (std::size_t d = 0; d < num_detections; ++d) {
    if (!is_claimed[d]) node.at("poses").refuse(fmt::format("expected a claim of detection {}", d));
  }
  return claims;
}

}  // namespace trivet::apps
