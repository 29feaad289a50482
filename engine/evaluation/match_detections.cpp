#include "engine/evaluation/match_detections.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>
#include <optional>
#include <tuple>

namespace trivet {

PoseMatcher::PoseMatcher(std::span<const EvaluationMesh> meshes) : has_meshes_(true) {
  for (const EvaluationMesh& mesh : meshes) judges_.try_emplace(mesh.name, mesh);
}

std::optional<double> PoseMatcher::distance(const Detection& first, const Detection& second) const {
  if (first.model != second.model) return std::nullopt;
  const Pose &a = first.T_scene_model, &b = second.T_scene_model;
  if (has_meshes_) {
    const auto judge = judges_.find(first.model);
    if (judge == judges_.end()) return std::nullopt;
    const engine::PoseError error = judge->second.error(a, b);
    return error.right() ? std::optional(error.rank()) : std::nullopt;
  }
  const double shift = (a.translation() - b.translation()).cast<double>().norm();
  const Eigen::Matrix3d turn = (a.linear().transpose() * b.linear()).cast<double>();
  const double angle = Eigen::AngleAxisd(turn).angle() * 180 / std::numbers::pi;
  if (!(shift < tolerance_.translation && angle < tolerance_.rotation_deg)) return std::nullopt;
  return shift / tolerance_.translation + angle / tolerance_.rotation_deg;
}

std::vector<DetectionMatch> PoseMatcher::match(std::span<const Detection> first,
                                               std::span<const Detection> second) const {
  std::vector<std::tuple<double, std::size_t, std::size_t>> alike;
  for (std::size_t i = 0; i < first.size(); ++i) {
    for (std::size_t j = 0; j < second.size(); ++j) {
      if (const std::optional<double> far = distance(first[i], second[j]))
        alike.emplace_back(*far, i, j);
    }
  }
  std::ranges::sort(alike);
  std::vector<bool> first_matched(first.size()), second_matched(second.size());
  std::vector<DetectionMatch> matches;
  for (const auto& [far, i, j] : alike) {
    if (first_matched[i] || second_matched[j]) continue;
    first_matched[i] = second_matched[j] = true;
    matches.push_back({i, j});
  }
  std::ranges::sort(matches, {}, &DetectionMatch::first);
  return matches;
}

}  // namespace trivet
