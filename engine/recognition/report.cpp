#include "engine/recognition/report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace trivet::engine {
namespace {

Pose in_file_unit(Pose pose, double scene_scale) {
  pose.translation() /= static_cast<float>(scene_scale);
  return pose;
}

kernels::SensorModel in_file_unit(kernels::SensorModel sensor, double scene_scale) {
  for (float* const length : {&sensor.range, &sensor.noise, &sensor.correlated_noise.height})
    *length /= static_cast<float>(scene_scale);
  return sensor;
}

Detection report_detection(const Library& library, const Candidate& candidate, double scene_scale) {
  const Model& model = library.models[candidate.model];
  const kernels::Examination& e = candidate.examination;
  const float seen = e.consistent + e.violation + e.background;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  Detection detection;
  detection.model = model.name;
  detection.source = candidate.source;
  detection.score = candidate.score;
  detection.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
  if (const float silhouette = e.covered + e.outside; silhouette > 0) {
    detection.visible_fraction = e.consistent / silhouette;
    detection.hidden_fraction = e.occluded / silhouette;
    detection.outside_fraction = e.outside / silhouette;
  }
  detection.violation = seen > 0 ? e.violation / seen : 0;
  detection.contour = outline > 0 ? 1 - e.outline_crossed / outline : 1;
  detection.rmse = std::sqrt(e.mean_square) * candidate.tolerance / static_cast<float>(scene_scale);
  detection.parts = candidate.parts;
  for (const Pose& alternative : candidate.alternatives)
    detection.alternatives.push_back(in_file_unit(alternative, scene_scale));
  for (const std::uint32_t sibling : candidate.siblings)
    detection.siblings.push_back(library.models[sibling].name);
  detection.pose_share = candidate.pose_share;
  detection.turns = candidate.turns;
  if (detection.turns) detection.turns->axis.point /= static_cast<float>(scene_scale);
  return detection;
}

/// place  of each detection in the order that they are reported in
RejectedPose report_rejected(const Library& library, const RefusedCandidate& refused,
                             std::span<const std::size_t> place, double scene_scale) {
  const Candidate& candidate = refused.candidate;
  RejectedPose rejected;
  rejected.model = library.models[candidate.model].name;
  rejected.score = candidate.score;
  rejected.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
  rejected.parts = candidate.parts;
  rejected.reason = refused.reason;
  if (refused.explained_by) rejected.explained_by = place[*refused.explained_by];
  rejected.explained_share = refused.explained_share;
  return rejected;
}

/// place  as for report_rejected
ModelExplanation report_explained(const Library& library, const ExplainedModel& explained,
                                  std::span<const std::size_t> place, double scene_scale) {
  ModelExplanation out;
  out.model = library.models[explained.model].name;
  out.num_poses = explained.num_poses;
  if (explained.detection) out.detection = place[*explained.detection];
  if (explained.pose) out.pose = report_rejected(library, *explained.pose, place, scene_scale);
  out.given_up = explained.given_up;
  out.rays = explained.rays;
  for (kernels::JudgedRay& ray : out.rays) ray.place /= static_cast<float>(scene_scale);
  return out;
}

/// Indices of candidates by falling score, ties by index.
std::vector<std::size_t> by_score(std::span<const Candidate> candidates) {
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    return candidates[a].score > candidates[b].score;
  });
  return order;
}

}  // namespace

SceneResult report(const Library& library, const PreparedScene& scene, SearchResult found,
                   SceneStats stats) {
  SceneResult result;
  const std::vector<std::size_t> order = by_score(found.detections);
  std::vector<std::size_t> place(order.size());
  for (std::size_t d = 0; d < order.size(); ++d) {
    place[order[d]] = d;
    result.detections.push_back(report_detection(library, found.detections[order[d]], scene.scale));
  }
  for (const RefusedCandidate& refused : found.rejected)
    result.rejected.push_back(report_rejected(library, refused, place, scene.scale));
  if (found.explained) {
    result.explanation.emplace();
    for (const ExplainedModel& explained : *found.explained)
      result.explanation->models.push_back(
          report_explained(library, explained, place, scene.scale));
  }
  result.stats = std::move(stats);
  result.stats.view = scene.view;
  result.stats.noise = scene.sensor.noise / static_cast<float>(scene.scale);
  if (scene.images.size() == 1) result.stats.sensor = in_file_unit(scene.sensor, scene.scale);
  return result;
}

}  // namespace trivet::engine
