#include "engine/evaluation/evaluate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

#include "engine/evaluation/manifest_inputs.hpp"
#include "engine/evaluation/pose_error.hpp"
#include "kernels/common/quantile.hpp"
#include "storage/common/precondition.hpp"

namespace trivet {
namespace {

using engine::PoseError;
using engine::PoseJudge;
using kernels::quantile;

/// Sums by ranges of a property that may be unknown for some truths.
class Bins {
 public:
  struct Edge {
    double below;
    const char* name;
  };
  /// The last bin contains all values above the last edge.
  explicit Bins(std::span<const Edge> edges) : edges_(edges), tallies_(edges.size() + 1) {}

  Tally& of(const std::optional<double>& value) {
    if (!value) return tallies_.back();
    std::size_t bin = 0;
    while (bin + 1 < edges_.size() && *value >= edges_[bin].below) ++bin;
    return tallies_[bin];
  }

  /// Bins with instances; none if all values are unknown.
  Tallies tallies() const {
    Tallies out;
    for (std::size_t bin = 0; bin < tallies_.size(); ++bin) {
      if (tallies_[bin].instances == 0) continue;
      const bool known = bin < edges_.size();
      if (!known && out.empty()) break;
      out.emplace_back(known ? edges_[bin].name : "unknown", tallies_[bin]);
    }
    return out;
  }

 private:
  std::span<const Edge> edges_;
  std::vector<Tally> tallies_;  // one per edge, then one for unknown values
};

constexpr std::array<Bins::Edge, 5> kOcclusionEdges{
    {{0.6, "<60%"}, {0.7, "60-70%"}, {0.8, "70-80%"}, {0.84, "80-84%"}, {1, ">84%"}}};
constexpr std::array<Bins::Edge, 5> kClutterEdges{
    {{0.6, "<60%"}, {0.8, "60-80%"}, {0.9, "80-90%"}, {0.95, "90-95%"}, {1, ">95%"}}};
constexpr std::array<Bins::Edge, 5> kVisibleEdges{
    {{0.2, "<20%"}, {0.4, "20-40%"}, {0.6, "40-60%"}, {0.8, "60-80%"}, {1, ">80%"}}};

std::vector<StageSeconds> stage_seconds(std::span<const std::optional<SceneResult>> results) {
  std::vector<std::pair<std::string, std::vector<double>>> stages;
  const auto values_of = [&](const std::string& stage) -> std::vector<double>& {
    for (auto& [name, values] : stages) {
      if (name == stage) return values;
    }
    return stages.emplace_back(stage, std::vector<double>{}).second;
  };
  std::vector<double> totals;
  for (const std::optional<SceneResult>& result : results) {
    if (!result) continue;
    for (const auto& [stage, seconds] : result->stats.times.seconds)
      values_of(stage).push_back(seconds);
    if (result->stats.total_seconds > 0) totals.push_back(result->stats.total_seconds);
  }
  if (!totals.empty()) stages.emplace_back("total", std::move(totals));
  std::vector<StageSeconds> out;
  out.reserve(stages.size());
  for (const auto& [stage, values] : stages)
    out.push_back({stage, *quantile(values, 0.5), *quantile(values, 0.95)});
  return out;
}

/// The names of the scored models, each with a mesh. Errors: bad_data (one has none).
Result<std::vector<std::string>> scored_with_mesh(const Manifest& manifest,
                                                  std::span<const EvaluationMesh> meshes) {
  std::vector<std::string> names = scored_models(manifest);
  for (const std::string& name : names) {
    if (find_mesh(meshes, name)) continue;
    return Error{ErrorCode::bad_data,
                 fmt::format("models_scored: expected names of the manifest's models, found '{}'; "
                             "list it under \"models\" with its file",
                             name)};
  }
  return names;
}

struct Match {
  std::size_t truth = 0;
  PoseError error;
};

/// The nearest of the `eligible` truths of a detection's model.
template <class Eligible>
std::optional<Match> nearest_truth(const PoseJudge& judge, const Detection& detection,
                                   const ManifestScene& scene, const Eigen::Vector3d& offset,
                                   Eligible&& eligible) {
  std::optional<Match> best;
  for (std::size_t t = 0; t < scene.truth.size(); ++t) {
    if (scene.truth[t].model != detection.model) continue;
    const PoseError error =
        judge.error(detection.T_scene_model, in_cloud_frame(scene.truth[t].file_pose(), offset));
    if (eligible(t, error) && (!best || error.rank() < best->error.rank())) best = Match{t, error};
  }
  return best;
}

/// What the least score is held against.
struct Asked {
  bool pose = false, identity = false;

  float score(const Detection& detection) const { return detection.asked_score(pose, identity); }
};

/// Judges one scene after another.
class Judge {
 public:
  Judge(std::vector<std::string> scored, std::span<const EvaluationMesh> meshes, float min_score,
        const Asked& asked)
      : scored_(std::move(scored)), min_score_(min_score), asked_(asked) {
    for (const EvaluationMesh& mesh : meshes) judges_.try_emplace(mesh.name, mesh);
  }

  SceneEvaluation judge(const ManifestScene& scene, const SceneResult& result) {
    const std::vector<Detection>& detections = result.detections;
    SceneEvaluation out;
    for (const TruthInstance& truth : scene.truth)
      out.truths.push_back({!truth.ignore && is_scored(truth.model), false, {}});
    std::vector<std::size_t> order(detections.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return detections[a].score > detections[b].score;
    });
    for (const std::size_t i : order) {
      JudgedDetection judged = judge_detection(scene, detections[i], result.offset, out.truths);
      judged.detection = i;
      if (judged.found) out.truths[*judged.truth].found_by = out.detections.size();
      out.detections.push_back(judged);
    }
    for (JudgedDetection& judged : out.detections)
      judge_candidates(scene, detections[judged.detection], result.offset, judged, out.truths);
    for (std::size_t t = 0; t < out.truths.size(); ++t) {
      const TruthOutcome& truth = out.truths[t];
      const bool found = truth.found_by && out.detections[*truth.found_by].reported;
      if (truth.counts && !found) out.missed.push_back(t);
    }
    return out;
  }

 private:
  bool is_scored(const std::string& name) const {
    return std::find(scored_.begin(), scored_.end(), name) != scored_.end();
  }

  JudgedDetection judge_detection(const ManifestScene& scene, const Detection& detection,
                                  const Eigen::Vector3d& offset,
                                  std::span<const TruthOutcome> truths) {
    JudgedDetection judged;
    judged.reported = asked_.score(detection) >= min_score_;
    judged.verdict = is_scored(detection.model) ? Verdict::wrong : Verdict::neutral;
    const auto found = judges_.find(detection.model);
    if (found == judges_.end()) return judged;
    PoseJudge& judge = found->second;
    std::optional<Match> match =
        nearest_truth(judge, detection, scene, offset, [&](std::size_t t, const PoseError& error) {
          return error.right() && !truths[t].found_by;
        });
    judged.found = match.has_value();
    if (match) {
      judged.verdict = truths[match->truth].counts ? Verdict::right : Verdict::neutral;
    } else {
      match = nearest_truth(judge, detection, scene, offset,
                            [](std::size_t, const PoseError&) { return true; });
    }
    if (!match) return judged;
    judged.truth = match->truth;
    judged.translation_error = match->error.translation;
    judged.rotation_error_deg = match->error.rotation_deg;
    judged.add = judge.add(detection.T_scene_model,
                           in_cloud_frame(scene.truth[match->truth].file_pose(), offset));
    return judged;
  }

  /// Mark the truth that a reported detection has among its candidates: the one that it finds, or
  /// else the nearest one of another candidate that none found yet.
  void judge_candidates(const ManifestScene& scene, const Detection& detection,
                        const Eigen::Vector3d& offset, JudgedDetection& judged,
                        std::span<TruthOutcome> truths) {
    if (!judged.reported) return;
    if (judged.found) {
      truths[*judged.truth].among_candidates = true;
      return;
    }
    for (const Candidate& candidate : detection.candidates) {
      const auto found = judges_.find(candidate.model);
      if (candidate.model == detection.model || found == judges_.end()) continue;
      Detection as_named;
      as_named.model = candidate.model;
      as_named.T_scene_model = candidate.T_scene_model;
      const std::optional<Match> match = nearest_truth(
          found->second, as_named, scene, offset, [&](std::size_t t, const PoseError& error) {
            return error.right() && !truths[t].found_by && !truths[t].among_candidates;
          });
      if (!match) continue;
      truths[match->truth].among_candidates = true;
      judged.misnamed = judged.verdict == Verdict::wrong;
      return;
    }
  }

  std::vector<std::string> scored_;
  float min_score_;
  Asked asked_;
  std::map<std::string, PoseJudge> judges_;
};

}  // namespace

double Tally::recall() const noexcept {
  return instances == 0 ? 0 : static_cast<double>(right) / static_cast<double>(instances);
}

double Tally::precision() const noexcept {
  const std::size_t all = right + false_positives;
  return all == 0 ? 0 : static_cast<double>(right) / static_cast<double>(all);
}

Result<Evaluation> evaluate(const Manifest& manifest, std::span<const EvaluationMesh> meshes,
                            std::span<const std::optional<SceneResult>> results, float min_score,
                            bool require_pose, bool require_identity) {
  TRIVET_REQUIRE(results.size() == manifest.scenes.size(), "one result, or none, for each scene");
  TRIVET_TRY_ASSIGN(const std::vector<std::string> scored, scored_with_mesh(manifest, meshes));
  const Asked asked{require_pose, require_identity};
  Judge judge(scored, meshes, min_score, asked);

  Evaluation out;
  std::map<std::string, Tally> models;
  Bins occlusion(kOcclusionEdges), clutter(kClutterEdges), visible(kVisibleEdges);
  std::vector<double> translation_errors, rotation_errors;
  std::vector<ScoredOutcome> outcomes;
  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    const ManifestScene& scene = manifest.scenes[s];
    static const SceneResult kNothing;
    const SceneResult& result = results[s] ? *results[s] : kNothing;
    const std::vector<Detection>& detections = result.detections;
    SceneEvaluation judged = judge.judge(scene, result);
    judged.missing = !results[s];
    out.num_missing += judged.missing ? 1 : 0;

    for (std::size_t t = 0; t < scene.truth.size(); ++t) {
      if (!judged.truths[t].counts) continue;
      const TruthInstance& truth = scene.truth[t];
      const auto found_by = judged.truths[t].found_by;
      const JudgedDetection* const finder = found_by ? &judged.detections[*found_by] : nullptr;
      const bool found = finder && finder->reported;
      for (Tally* tally :
           {&out.total, &judged.tally, &models[truth.model], &occlusion.of(truth.occlusion),
            &clutter.of(truth.clutter), &visible.of(truth.visible_fraction)}) {
        ++tally->instances;
        tally->right += found ? 1 : 0;
        tally->add_right += found && finder->add < kMaxAdd ? 1 : 0;
        tally->among_candidates += judged.truths[t].among_candidates ? 1 : 0;
      }
      if (!found) continue;
      translation_errors.push_back(finder->translation_error);
      rotation_errors.push_back(finder->rotation_error_deg);
    }
    for (const JudgedDetection& detection : judged.detections) {
      if (detection.verdict == Verdict::neutral) continue;
      const Detection& own = detections[detection.detection];
      outcomes.push_back(
          {static_cast<double>(asked.score(own)), detection.verdict == Verdict::right});
      if (detection.verdict == Verdict::right || !detection.reported) continue;
      for (Tally* tally : {&out.total, &judged.tally, &models[own.model]}) {
        ++tally->false_positives;
        tally->misnamed += detection.misnamed ? 1 : 0;
      }
    }
    out.scenes.push_back(std::move(judged));
  }

  out.by_occlusion = occlusion.tallies();
  out.by_clutter = clutter.tallies();
  out.by_visible_fraction = visible.tallies();
  for (const std::string& name : scored) {
    if (const auto found = models.find(name); found != models.end())
      out.by_model.emplace_back(*found);
  }
  out.median_translation_error = quantile(std::move(translation_errors), 0.5);
  out.median_rotation_error_deg = quantile(std::move(rotation_errors), 0.5);
  out.seconds = stage_seconds(results);
  out.curve = precision_recall(outcomes, out.total.instances);
  out.calibration = calibrate(outcomes);
  return out;
}

}  // namespace trivet
