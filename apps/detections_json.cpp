#include "apps/detections_json.hpp"

namespace trivet::apps {
namespace {

nlohmann::ordered_json matrix_json(const Pose& pose) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  const Eigen::Matrix4f matrix = pose.matrix();
  for (Eigen::Index row = 0; row < 4; ++row) {
    rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  }
  return rows;
}

}  // namespace

nlohmann::ordered_json scene_json(const std::string& file, const SceneResult& result) {
  nlohmann::ordered_json seconds, detections = nlohmann::ordered_json::array();
  for (const auto& [stage, value] : result.stats.times.seconds) seconds[stage] = value;
  seconds["total"] = result.stats.total_seconds;
  for (const Detection& detection : result.detections) {
    detections.push_back({{"model", detection.model},
                          {"score", detection.score},
                          {"T_scene_model", matrix_json(detection.T_scene_model)},
                          {"visible_fraction", detection.visible_fraction},
                          {"violation", detection.violation},
                          {"contour", detection.contour},
                          {"rmse", detection.rmse},
                          {"method", "ppf"}});
  }
  const SceneStats& stats = result.stats;
  return {{"scene", file},
          {"points", stats.num_points},
          {"invalid_points", stats.num_invalid},
          {"noise", stats.noise},
          {"seconds", std::move(seconds)},
          {"counts",
           {{"references", stats.num_references},
            {"pairs", stats.num_pairs},
            {"votes", stats.num_votes},
            {"hypotheses", stats.num_hypotheses},
            {"refined", stats.num_refined}}},
          {"detections", std::move(detections)}};
}

}  // namespace trivet::apps
