#include "engine/recognition/report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/common/checked_parts.hpp"
#include "engine/common/parallel.hpp"
#include "kernels/symmetry/find_difference.hpp"

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

/// What tells a candidate from the first one, whose pose is that of the detection; none if a
/// model has no samples, or they are damaged.
std::optional<CandidateDifference> report_difference(const Library& library,
                                                     const PosedCandidate& first,
                                                     const PosedCandidate& candidate,
                                                     double scene_scale) {
  const auto samples = kernel_samples(library, first.model),
             others = kernel_samples(library, candidate.model);
  if (!samples || !others || samples->points.size() == 0 || others->points.size() == 0)
    return std::nullopt;
  const auto [deviation, center, size, look_from] =
      kernels::find_difference(*samples, *others, candidate.T_first_model);
  const auto scale = static_cast<float>(scene_scale);
  return CandidateDifference{first.T_scene_model * center / scale, size / scale, deviation / scale,
                             first.T_scene_model.linear() * look_from};
}

std::vector<Candidate> report_candidates(const Library& library, const PoseTable& poses, Row row,
                                         double scene_scale) {
  const std::vector<PosedCandidate>& posed = poses.ambiguity(row).candidates;
  std::vector<Candidate> candidates;
  for (const PosedCandidate& candidate : posed) {
    Candidate& out = candidates.emplace_back();
    out.model = library.models[candidate.model].name;
    out.share = candidate.share;
    out.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
    if (&candidate == &posed.front()) continue;
    out.log_odds = candidate.log_odds;
    out.rays = candidate.num_measured;
    out.differs = report_difference(library, posed.front(), candidate, scene_scale);
  }
  if (candidates.empty()) {
    candidates.push_back({.model = library.models[poses.model[row]].name,
                          .T_scene_model = in_file_unit(poses.T_scene_model[row], scene_scale)});
  }
  return candidates;
}

Detection report_detection(const Library& library, const PoseTable& poses, Row row,
                           double scene_scale) {
  const FullTest& test = poses.test(row);
  const Ambiguity& ambiguity = poses.ambiguity(row);
  const kernels::Examination& e = test.examination;
  const float measured = e.consistent + e.violation + e.background;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  Detection detection;
  detection.model = library.models[poses.model[row]].name;
  detection.source = poses.source[row];
  detection.score = poses.score[row];
  detection.T_scene_model = in_file_unit(poses.T_scene_model[row], scene_scale);
  if (const float silhouette = e.covered + e.outside; silhouette > 0) {
    detection.visible_fraction = e.consistent / silhouette;
    detection.hidden_fraction = e.occluded / silhouette;
    detection.outside_fraction = e.outside / silhouette;
  }
  detection.violation = measured > 0 ? e.violation / measured : 0;
  detection.contour = outline > 0 ? 1 - e.outline_crossed / outline : 1;
  detection.rmse = std::sqrt(e.mean_square) * e.tolerance / static_cast<float>(scene_scale);
  detection.deviation = e.deviation / static_cast<float>(scene_scale);
  detection.parts = test.parts;
  detection.covariance = test.covariance;
  detection.covariance.topRows<3>() /= static_cast<float>(scene_scale);
  detection.covariance.leftCols<3>() /= static_cast<float>(scene_scale);
  for (const Pose& alternative : ambiguity.alternatives)
    detection.alternatives.push_back(in_file_unit(alternative, scene_scale));
  detection.candidates = report_candidates(library, poses, row, scene_scale);
  detection.pose_share = ambiguity.pose_share;
  detection.turns = ambiguity.turns;
  if (detection.turns) detection.turns->axis.point /= static_cast<float>(scene_scale);
  return detection;
}

/// The reason why a tested pose is not a detection.
Rejection rejection_of(PoseFate fate) {
  if (fate == PoseFate::explained) return Rejection::explained;
  return fate == PoseFate::too_many ? Rejection::too_many : Rejection::too_low;
}

/// The index of a row among the detections; absent if it is not one.
std::optional<std::size_t> index_of(std::optional<Row> row, std::span<const Row> detections) {
  if (!row) return std::nullopt;
  const auto at = std::ranges::find(detections, *row);
  if (at == detections.end()) return std::nullopt;
  return static_cast<std::size_t>(at - detections.begin());
}

/// detections  in their reported order
RejectedPose report_rejected(const Library& library, const PoseTable& poses, Row row,
                             std::span<const Row> detections, double scene_scale) {
  RejectedPose rejected;
  rejected.model = library.models[poses.model[row]].name;
  rejected.score = poses.score[row];
  rejected.T_scene_model = in_file_unit(poses.T_scene_model[row], scene_scale);
  rejected.parts = poses.test(row).parts;
  rejected.reason = rejection_of(poses.fate[row]);
  rejected.depth_in_ground =
      poses.test(row).depth_in_ground / library.models[poses.model[row]].diameter;
  rejected.explained_by = index_of(poses.explained_by[row], detections);
  if (rejected.explained_by) rejected.explained_share = poses.explained_share[row];
  return rejected;
}

/// detections  as for report_rejected
ModelExplanation report_explained(const Library& library, const PoseTable& poses,
                                  const ExplainedModel& explained, std::span<const Row> detections,
                                  double scene_scale) {
  ModelExplanation out;
  out.model = library.models[explained.model].name;
  out.num_poses = explained.num_poses;
  out.detection = index_of(explained.pose, detections);
  if (explained.pose && !out.detection)
    out.pose = report_rejected(library, poses, *explained.pose, detections, scene_scale);
  out.given_up = explained.given_up;
  out.rays = explained.rays;
  for (kernels::JudgedRay& ray : out.rays) ray.place /= static_cast<float>(scene_scale);
  return out;
}

}  // namespace

SceneResult report(const Library& library, const PreparedScene& scene, const SearchResult& found,
                   SceneStats stats) {
  SceneResult result;
  const PoseTable& poses = found.poses;
  const std::vector<Row> detections = by_falling(poses.score, found.detections);
  result.detections.resize(detections.size());
  for_each_index(detections.size(), [&](std::size_t k) {
    result.detections[k] = report_detection(library, poses, detections[k], scene.scale);
  });
  for (const Row row : found.rejected)
    result.rejected.push_back(report_rejected(library, poses, row, detections, scene.scale));
  if (found.explained) {
    result.explanation.emplace();
    for (const ExplainedModel& explained : *found.explained)
      result.explanation->models.push_back(
          report_explained(library, poses, explained, detections, scene.scale));
  }
  result.stats = std::move(stats);
  result.stats.view = scene.view;
  result.stats.noise = scene.sensor.noise / static_cast<float>(scene.scale);
  if (scene.images.size() == 1) result.stats.sensor = in_file_unit(scene.sensor, scene.scale);
  return result;
}

}  // namespace trivet::engine
