#include "apps/results/detections_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "apps/words/camera_words.hpp"
#include "apps/words/explanation_words.hpp"
#include "apps/words/rejection_words.hpp"
#include "apps/words/view_words.hpp"
#include "storage/files/json_file.hpp"
#include "storage/formats/camera_json.hpp"

namespace trivet::apps {
namespace {

nlohmann::ordered_json parts_json(const kernels::ScoreParts& parts) {
  nlohmann::ordered_json json;
  for (std::size_t k = 0; k < parts.size(); ++k)
    json[std::string(kernels::kScoreParts[k].name)] = parts[k];
  return json;
}

/// The contribution of each part to the log odds.
nlohmann::ordered_json evidence_json(const kernels::ScoreModel& score,
                                     const kernels::ScoreParts& parts) {
  nlohmann::ordered_json json;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    json[std::string(kernels::kScoreParts[k].name)] = kernels::part_evidence(score, parts, k);
  }
  return json;
}

nlohmann::ordered_json pose_json(const kernels::ScoreModel& score, const SceneResult& result,
                                 const RejectedPose& pose, const RecognizeOptions& options) {
  return {
      {"model", pose.model},
      {"score", pose.score},
      {"T_scene_model", matrix_json(in_file_frame(pose.T_scene_model, result.offset))},
      {"parts", parts_json(pose.parts)},
      {"evidence", evidence_json(score, pose.parts)},
      {"reason", name_of(pose.reason)},
      {"explained_by", pose.explained_by ? nlohmann::ordered_json(*pose.explained_by) : nullptr},
      {"explained_share", pose.explained_share},
      {"words", rejection_words(result, pose, score, options).text()}};
}

nlohmann::ordered_json rejected_json(const kernels::ScoreModel& score, const SceneResult& result,
                                     const RecognizeOptions& options) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RejectedPose& pose : result.rejected)
    json.push_back(pose_json(score, result, pose, options));
  return json;
}

/// Grouped by their verdict, x, y, z of each place in the frame of the scene's file.
nlohmann::ordered_json rays_json(const SceneResult& result,
                                 std::span<const kernels::JudgedRay> rays) {
  nlohmann::ordered_json json;
  for (const std::string_view verdict : kRayVerdicts)
    json[std::string(verdict)] = nlohmann::ordered_json::array();
  for (const kernels::JudgedRay& ray : rays) {
    nlohmann::ordered_json& places =
        json[std::string(kRayVerdicts[static_cast<std::size_t>(ray.verdict)])];
    const Eigen::Vector3d place = ray.place.cast<double>() + result.offset;
    for (const double x : place) places.push_back(std::round(1e6 * x) / 1e6);
  }
  return json;
}

nlohmann::ordered_json explanation_json(const SceneResult& result, const kernels::ScoreModel& score,
                                        const RecognizeOptions& options) {
  const PlaceExplanation& place = *result.explanation;
  nlohmann::ordered_json models = nlohmann::ordered_json::array();
  for (const ModelExplanation& of : place.models) {
    nlohmann::ordered_json pose, reached;
    if (of.pose) pose = pose_json(score, result, *of.pose, options);
    if (const auto stage = of.reached()) reached = kPoseStages[static_cast<std::size_t>(*stage)];
    nlohmann::ordered_json num_poses;
    for (std::size_t k = 0; k < kNumPoseStages; ++k)
      num_poses[std::string(kPoseStages[k])] = of.num_poses[k];
    models.push_back({{"model", of.model},
                      {"poses", std::move(num_poses)},
                      {"reached", std::move(reached)},
                      {"detection", of.detection ? nlohmann::ordered_json(*of.detection) : nullptr},
                      {"given_up", of.given_up},
                      {"pose", std::move(pose)},
                      {"rays", rays_json(result, of.rays)},
                      {"words", explanation_words(result, of, score, options)},
                      {"stage_words", stage_words(of)}});
  }
  return {{"point", {place.point.x(), place.point.y(), place.point.z()}},
          {"nearest_point", place.nearest_point},
          {"models", std::move(models)}};
}

nlohmann::ordered_json difference_json(const CandidateDifference& differs,
                                       const Eigen::Vector3d& offset) {
  const Eigen::Vector3d center = differs.center.cast<double>() + offset;
  const Eigen::Vector3f& from = differs.look_from;
  return {{"center", {center.x(), center.y(), center.z()}},
          {"size", differs.size},
          {"deviation", differs.deviation},
          {"look_from", {from.x(), from.y(), from.z()}}};
}

nlohmann::ordered_json candidates_json(const Detection& detection, const Eigen::Vector3d& offset) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Candidate& candidate : detection.candidates) {
    nlohmann::ordered_json one{{"model", candidate.model}, {"share", candidate.share}};
    if (candidate.differs) {
      one["T_scene_model"] = matrix_json(in_file_frame(candidate.T_scene_model, offset));
      one["log_odds"] = candidate.log_odds;
      one["rays"] = candidate.rays;
      one["differs"] = difference_json(*candidate.differs, offset);
    }
    json.push_back(std::move(one));
  }
  return json;
}

nlohmann::ordered_json alternatives_json(const std::vector<Pose>& alternatives,
                                         const Eigen::Vector3d& offset) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const Pose& alternative : alternatives)
    json.push_back(matrix_json(in_file_frame(alternative, offset)));
  return json;
}

/// The axis in the model's frame, in the scene file's unit, and the equally likely angles.
nlohmann::ordered_json turns_json(const std::optional<TurnExtent>& turns) {
  if (!turns) return nullptr;
  constexpr float kDegreesPerRadian = 57.29578F;
  const auto vector = [](const Eigen::Vector3f& v) { return std::array{v.x(), v.y(), v.z()}; };
  return {{"axis", vector(turns->axis.direction)},
          {"point", vector(turns->axis.point)},
          {"from_deg", kDegreesPerRadian * turns->low},
          {"to_deg", kDegreesPerRadian * turns->high}};
}

/// Standard deviations along and about the model's axes, and the whole covariance in rows; lengths
/// in the scene file's unit, angles of the covariance in rad.
nlohmann::ordered_json sigma_json(const kernels::PoseCovariance& covariance) {
  if (covariance.isZero(0)) return nullptr;
  constexpr float kDegreesPerRadian = 57.29578F;
  const Eigen::Matrix<float, 6, 1> sigma = kernels::pose_sigma(covariance);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < 6; ++row) {
    nlohmann::ordered_json& numbers = rows.emplace_back(nlohmann::ordered_json::array());
    for (Eigen::Index column = 0; column < 6; ++column) numbers.push_back(covariance(row, column));
  }
  const Eigen::Vector3f angles = kDegreesPerRadian * sigma.tail<3>();
  return {{"translation", {sigma[0], sigma[1], sigma[2]}},
          {"rotation_deg", {angles.x(), angles.y(), angles.z()}},
          {"covariance", std::move(rows)}};
}

/// Lengths in the scene file's unit; null for closed surfaces, which no sensor has measured.
nlohmann::ordered_json sensor_json(const std::optional<kernels::SensorModel>& sensor) {
  if (!sensor) return nullptr;
  return {{"range", sensor->range},
          {"noise", sensor->noise},
          {"correlated_noise", sensor->correlated_noise.height},
          {"exponent", sensor->exponent},
          {"correlation", sensor->correlation},
          {"edge_pixels", sensor->edge_pixels()},
          {"smoothing", sensor->smoothing}};
}

/// The viewpoint in the scene file's frame and unit; null for scenes without a single viewpoint.
nlohmann::ordered_json view_json(const std::optional<SceneView>& view) {
  if (!view) return nullptr;
  nlohmann::ordered_json viewpoint;
  const std::optional<std::string> words = view_words(*view);
  if (view->viewpoint)
    viewpoint = {view->viewpoint->x(), view->viewpoint->y(), view->viewpoint->z()};
  return {{"kind", name_of(view->kind)},
          {"source", name_of(view->source)},
          {"viewpoint", std::move(viewpoint)},
          {"words", words ? nlohmann::ordered_json(*words) : nullptr}};
}

/// A candidate without a pose of its own has that of the detection.
Candidate parse_candidate(const JsonNode& node, const Detection& detection,
                          const Eigen::Vector3d& offset) {
  return {.model = node.at("model").string(),
          .share = static_cast<float>(node.at("share").number()),
          .T_scene_model = node.has("T_scene_model")
                               ? in_cloud_frame(node.at("T_scene_model").file_pose(), offset)
                               : detection.T_scene_model};
}

/// offset  of the cloud with the detection
Detection parse_detection(const JsonNode& node, const Eigen::Vector3d& offset) {
  const auto number = [&](std::string_view key) {
    return node.has(key) ? static_cast<float>(node.at(key).number())
                         : std::numeric_limits<float>::quiet_NaN();
  };
  Detection detection{node.at("model").string(),
                      static_cast<float>(node.at("score").number()),
                      in_cloud_frame(node.at("T_scene_model").file_pose(), offset),
                      number("visible_fraction"),
                      number("violation"),
                      number("contour"),
                      number("rmse"),
                      number("deviation"),
                      {},
                      {}};
  if (node.has("pose_share")) detection.pose_share = number("pose_share");
  if (node.has("candidates")) {
    for (const JsonNode& candidate : node.at("candidates").elements())
      detection.candidates.push_back(parse_candidate(candidate, detection, offset));
  }
  return detection;
}

/// The offset of the document. Results of other programs far from zero are compared near their
/// first pose.
Eigen::Vector3d offset_of(const JsonNode& scene) {
  constexpr double kFar = 1e5;
  if (scene.has("offset")) return scene.at("offset").vector3();
  const std::vector<JsonNode> detections = scene.at("detections").elements();
  if (detections.empty()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d first = detections[0].at("T_scene_model").file_pose().translation();
  if (first.cwiseAbs().maxCoeff() < kFar) return Eigen::Vector3d::Zero();
  return first.array().round();
}

StoredScene parse_scene(const JsonNode& node) {
  StoredScene scene{node.at("scene").string(), {}};
  scene.result.offset = offset_of(node);
  for (const JsonNode& detection : node.at("detections").elements())
    scene.result.detections.push_back(parse_detection(detection, scene.result.offset));
  if (!node.has("seconds")) return scene;
  for (const auto& [stage, seconds] : node.at("seconds").members()) {
    if (stage == "total") {
      scene.result.stats.total_seconds = seconds.number();
    } else {
      scene.result.stats.times.add(stage, seconds.number());
    }
  }
  return scene;
}

std::filesystem::path normal_path(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).lexically_normal();
}

bool ends_with(const std::filesystem::path& path, const std::string& name) {
  return path == name || path.string().ends_with("/" + name);
}

}  // namespace

std::string_view name_of(Rejection reason) {
  switch (reason) {
    case Rejection::too_low:
      return "too_low";
    case Rejection::explained:
      return "explained";
    case Rejection::too_many:
      return "too_many";
  }
  return "";
}

nlohmann::ordered_json matrix_json(const FilePose& pose) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  const Eigen::Matrix4d matrix = pose.matrix();
  for (Eigen::Index row = 0; row < 4; ++row) {
    rows.push_back({matrix(row, 0), matrix(row, 1), matrix(row, 2), matrix(row, 3)});
  }
  return rows;
}

nlohmann::ordered_json camera_check_json(const CameraCheck& check) {
  std::optional<kernels::Factor> focal, depth;
  if (check.scale) {
    focal = check.scale->focal;
    depth = check.scale->depth;
  }
  const auto number = [](const std::optional<kernels::Factor>& factor,
                         double kernels::Factor::*of) {
    return factor ? nlohmann::ordered_json((*factor).*of) : nullptr;
  };
  const std::optional<std::string> finding = camera_finding(check);
  return {{"camera", camera_json(check.camera)},
          {"objects", check.objects.size()},
          {"focal_scale", number(focal, &kernels::Factor::value)},
          {"focal_scale_error", number(focal, &kernels::Factor::error)},
          {"depth_scale", number(depth, &kernels::Factor::value)},
          {"depth_scale_error", number(depth, &kernels::Factor::error)},
          {"finding", finding ? nlohmann::ordered_json(*finding) : nullptr}};
}

nlohmann::ordered_json scene_json(const std::string& file, const SceneResult& result,
                                  const kernels::ScoreModel& score,
                                  const RecognizeOptions& options) {
  nlohmann::ordered_json seconds, detections = nlohmann::ordered_json::array();
  for (const auto& [stage, value] : result.stats.times.seconds) seconds[stage] = value;
  seconds["total"] = result.stats.total_seconds;
  for (const Detection& detection : result.detections) {
    detections.push_back(
        {{"model", detection.model},
         {"score", detection.score},
         {"T_scene_model", matrix_json(in_file_frame(detection.T_scene_model, result.offset))},
         {"visible_fraction", detection.visible_fraction},
         {"hidden_fraction", detection.hidden_fraction},
         {"outside_fraction", detection.outside_fraction},
         {"violation", detection.violation},
         {"contour", detection.contour},
         {"rmse", detection.rmse},
         {"deviation", detection.deviation},
         {"parts", parts_json(detection.parts)},
         {"evidence", evidence_json(score, detection.parts)},
         {"alone", kernels::pose_probability(score, detection.parts)},
         {"ambiguous", detection.is_ambiguous()},
         {"pose_share", detection.pose_share},
         {"pose_sigma", sigma_json(detection.covariance)},
         {"turns", turns_json(detection.turns)},
         {"alternatives", alternatives_json(detection.alternatives, result.offset)},
         {"identity", detection.identity()},
         {"candidates", candidates_json(detection, result.offset)},
         {"method", name_of(detection.source)},
         {"words", cost_words(detection, score)}});
  }
  const SceneStats& stats = result.stats;
  nlohmann::ordered_json json{
      {"scene", file},
      {"points", stats.num_points},
      {"invalid_points", stats.num_invalid},
      {"noise", stats.noise},
      {"view", view_json(stats.view)},
      {"sensor", sensor_json(stats.sensor)},
      {"camera_check", stats.camera_check ? camera_check_json(*stats.camera_check)
                                          : nlohmann::ordered_json(nullptr)},
      {"seconds", std::move(seconds)},
      {"counts",
       {{"references", stats.num_references},
        {"pairs", stats.num_pairs},
        {"votes", stats.num_votes},
        {"hypotheses", stats.num_hypotheses},
        {"refined", stats.num_refined},
        {"examined", stats.num_examined}}},
      {"detections", std::move(detections)}};
  if (stats.num_stray > 0) json["stray_points"] = stats.num_stray;
  if (const Eigen::Vector3d& o = result.offset; !o.isZero(0))
    json["offset"] = {o.x(), o.y(), o.z()};
  if (options.max_rejected > 0) json["rejected"] = rejected_json(score, result, options);
  if (result.explanation) json["explanation"] = explanation_json(result, score, options);
  return json;
}

nlohmann::ordered_json failed_scene_json(const std::string& file, const Error& error) {
  return {{"scene", file}, {"error", error.message}};
}

Result<std::vector<ExpectedPose>> read_expected_poses(const std::filesystem::path& file) {
  std::vector<ExpectedPose> expected;
  const Result<void> done = with_json(file, [&](const JsonNode& root) {
    for (const JsonNode& scene : root.at("scenes").elements()) {
      if (scene.has("error")) continue;
      for (const JsonNode& detection : scene.at("detections").elements())
        expected.push_back(
            {detection.at("model").string(), detection.at("T_scene_model").file_pose()});
    }
  });
  if (!done) return done.error();
  return expected;
}

Result<std::vector<StoredScene>> read_stored_scenes(const std::filesystem::path& file) {
  std::vector<StoredScene> stored;
  std::set<std::filesystem::path> visited;
  const Result<void> done = with_json(file, [&](const JsonNode& root) {
    for (const JsonNode& scene : root.at("scenes").elements()) {
      if (scene.has("error")) continue;
      stored.push_back(parse_scene(scene));
      if (!visited.insert(normal_path(stored.back().file)).second)
        scene.at("scene").refuse("expected each scene once");
    }
  });
  if (!done) return done.error();
  return stored;
}

Result<std::vector<std::optional<SceneResult>>> read_detections(const std::filesystem::path& file,
                                                                const Manifest& manifest) {
  const Result<std::vector<StoredScene>> read = read_stored_scenes(file);
  if (!read) return read.error();
  const std::vector<StoredScene>& stored = *read;

  std::vector<std::optional<SceneResult>> results;
  for (const ManifestScene& scene : manifest.scenes) {
    const auto same = [&](const StoredScene& other) {
      return normal_path(other.file) == normal_path(scene.file);
    };
    const auto alike = [&](const StoredScene& other) { return ends_with(other.file, scene.name); };
    auto found = std::find_if(stored.begin(), stored.end(), same);
    if (found == stored.end() && std::count_if(stored.begin(), stored.end(), alike) == 1) {
      found = std::find_if(stored.begin(), stored.end(), alike);
    }
    results.push_back(found == stored.end() ? std::nullopt : std::optional(found->result));
  }
  return results;
}

}  // namespace trivet::apps
