#include "apps/words/reported_part.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trivet::apps {
namespace {

bool is_reported(const Detection& detection, const RecognizeOptions& options) {
  return detection.asked_score(options.require_pose, options.require_identity) >= options.min_score;
}

RejectedPose rejected_of(const Detection& detection) {
  return {detection.model, detection.score, detection.T_scene_model, detection.parts};
}

}  // namespace

SceneResult reported_part(SceneResult result, const RecognizeOptions& options) {
  if (!options.doubtful_score) return result;
  std::vector<Detection> all = std::exchange(result.detections, {});
  std::vector<std::optional<std::size_t>> place(all.size());
  for (std::size_t d = 0; d < all.size(); ++d) {
    if (is_reported(all[d], options)) {
      place[d] = result.detections.size();
      result.detections.push_back(std::move(all[d]));
    } else {
      result.rejected.push_back(rejected_of(all[d]));
    }
  }
  for (RejectedPose& rejected : result.rejected) {
    if (rejected.explained_by) rejected.explained_by = place[*rejected.explained_by];
  }
  std::ranges::stable_sort(result.rejected, [](const RejectedPose& a, const RejectedPose& b) {
    return a.score > b.score;
  });
  std::map<std::string, std::uint32_t> num_rejected;  // keyed by model
  std::erase_if(result.rejected, [&](const RejectedPose& rejected) {
    return ++num_rejected[rejected.model] > options.max_rejected;
  });
  return result;
}

}  // namespace trivet::apps
