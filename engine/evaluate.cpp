#include "engine/evaluate.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "engine/manifest_inputs.hpp"
#include "kernels/voxel_hash.hpp"

namespace trivet {
namespace {

constexpr double kMaxTranslation = 0.1;  // of the diameter
constexpr double kMaxRotationDeg = 12;
constexpr double kMaxAdd = 0.1;  // of the diameter
/// A mean over more vertices takes longer and tells no more.
constexpr std::size_t kMaxAddVertices = 3000;

using Eigen::Matrix3d;
using Eigen::Vector3d;

struct PoseError {
  double translation = 0;  // in diameters
  double rotation_deg = 0;

  bool right() const noexcept {
    return translation < kMaxTranslation && rotation_deg < kMaxRotationDeg;
  }
  /// The larger share of either limit weighs as much as the other.
  double rank() const noexcept {
    return translation / kMaxTranslation + rotation_deg / kMaxRotationDeg;
  }
};

double degrees(double radians) noexcept { return radians * 180 / std::numbers::pi; }

/// A model as the manifest sees it: in its unit, with its symmetries.
class Target {
 public:
  Target(const Model& model, const std::optional<Symmetry>& symmetry, double scale)
      : model_(model), scale_(scale), diameter_(scale * static_cast<double>(model.diameter)) {
    if (symmetry) symmetry_ = *symmetry;
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < model.vertices.size(); ++i) box.extend(vertex(i));
    centre_ = box.center();
  }

  PoseError error(const Pose& estimate, const Pose& truth) const {
    PoseError best = error_of_one(estimate, truth);
    for (const Pose& S : symmetry_.poses) {
      const PoseError error = error_of_one(estimate, truth * S);
      if (error.rank() < best.rank()) best = error;
    }
    return best;
  }

  bool add_right(const Pose& estimate, const Pose& truth) {
    // In the truth's model frame, where the vertices lie still.
    const Eigen::Isometry3d motion = (truth.inverse() * estimate).cast<double>();
    const std::size_t n = model_.vertices.size();
    const std::size_t stride = (n + kMaxAddVertices - 1) / kMaxAddVertices;
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < n; i += stride, ++count) {
      const Vector3d moved = motion * vertex(i);
      sum += symmetry_.trivial() ? (moved - vertex(i)).norm() : distance_to_vertices(moved);
    }
    return sum < kMaxAdd * diameter_ * static_cast<double>(count);
  }

 private:
  Vector3d vertex(std::size_t i) const { return scale_ * model_.vertices[i].cast<double>(); }

  PoseError error_of_one(const Pose& estimate, const Pose& truth) const {
    const Matrix3d a = estimate.linear().cast<double>(), b = truth.linear().cast<double>();
    const Vector3d shift = a * centre_ + estimate.translation().cast<double>() - b * centre_ -
                           truth.translation().cast<double>();
    double angle = 0;
    if (symmetry_.axis) {
      const Vector3d axis = symmetry_.axis->direction.cast<double>();
      angle = std::atan2((a * axis).cross(b * axis).norm(), (a * axis).dot(b * axis));
    } else {
      angle = Eigen::AngleAxisd(Matrix3d(a.transpose() * b)).angle();
    }
    return {shift.norm() / diameter_, degrees(angle)};
  }

  double distance_to_vertices(const Vector3d& point) {
    if (!grid_) {
      const double spacing = static_cast<double>(model_.diameter) /
                             std::sqrt(static_cast<double>(model_.vertices.size()));
      grid_.emplace(model_.vertices, static_cast<float>(2 * spacing));
    }
    const auto nearest =
        grid_->nearest((point / scale_).cast<float>(), std::numeric_limits<float>::infinity());
    return nearest ? scale_ * std::sqrt(static_cast<double>(nearest->squared_distance)) : diameter_;
  }

  const Model& model_;
  double scale_, diameter_;
  Symmetry symmetry_;
  Vector3d centre_;
  std::optional<kernels::VoxelHash> grid_;  // for ADD-S only
};

/// The models of a manifest by name, made ready when first needed.
class Targets {
 public:
  Targets(const Manifest& manifest, const Library& library)
      : manifest_(manifest),
        library_(library),
        scale_(unit_scale(library.header.unit, manifest.unit)) {}

  Result<Target*> find(const std::string& name) {
    if (const auto found = targets_.find(name); found != targets_.end()) return &found->second;
    const auto named = [&](const auto& model) { return model.name == name; };
    const auto model = std::find_if(library_.models.begin(), library_.models.end(), named);
    if (model == library_.models.end()) {
      return Error{ErrorCode::bad_data,
                   fmt::format("{}: expected the model '{}' that was detected, found none of that "
                               "name; use the library that gave the detections",
                               library_.file.string(), name)};
    }
    const auto declared = std::find_if(manifest_.models.begin(), manifest_.models.end(), named);
    const auto symmetry = declared == manifest_.models.end() ? std::nullopt : declared->symmetry;
    return &targets_.try_emplace(name, *model, symmetry, scale_).first->second;
  }

 private:
  const Manifest& manifest_;
  const Library& library_;
  double scale_;
  std::map<std::string, Target> targets_;
};

constexpr std::array<std::pair<double, const char*>, 5> kOcclusionBins{
    {{0.6, "<60%"}, {0.7, "60-70%"}, {0.8, "70-80%"}, {0.84, "80-84%"}, {1e9, ">84%"}}};

/// Bin of an occlusion; the last one is for those that are not known.
std::size_t occlusion_bin(const std::optional<double>& occlusion) {
  std::size_t bin = 0;
  if (!occlusion) return kOcclusionBins.size();
  while (bin + 1 < kOcclusionBins.size() && *occlusion >= kOcclusionBins[bin].first) ++bin;
  return bin;
}

std::optional<double> median(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  const std::size_t half = values.size() / 2;
  std::sort(values.begin(), values.end());
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

StageTimes median_times(std::span<const std::optional<SceneResult>> results) {
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
    totals.push_back(result->stats.total_seconds);
  }
  StageTimes times;
  for (auto& [stage, values] : stages) times.add(stage, median(std::move(values)).value_or(0));
  if (!totals.empty()) times.add("total", *median(std::move(totals)));
  return times;
}

struct Match {
  std::size_t truth = 0;
  PoseError error;
};

/// Among the truths not found yet, the one that a detection is right about and fits best.
std::optional<Match> best_match(const Target& target, const Detection& detection,
                                const ManifestScene& scene, const std::vector<bool>& found) {
  std::optional<Match> best;
  for (std::size_t t = 0; t < scene.truth.size(); ++t) {
    if (found[t] || scene.truth[t].model != detection.model) continue;
    const PoseError error = target.error(detection.T_scene_model, scene.truth[t].T_scene_model);
    if (error.right() && (!best || error.rank() < best->error.rank())) best = Match{t, error};
  }
  return best;
}

Result<SceneEvaluation> judge_scene(const ManifestScene& scene,
                                    const std::vector<std::string>& scored,
                                    const SceneResult& result, Targets& targets) {
  SceneEvaluation out;
  const auto is_scored = [&](const std::string& name) {
    return std::find(scored.begin(), scored.end(), name) != scored.end();
  };
  const auto counts = [&](const TruthInstance& truth) {
    return !truth.ignore && is_scored(truth.model);
  };
  std::vector<std::size_t> order(result.detections.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return result.detections[a].score > result.detections[b].score;
  });

  std::vector<bool> found(scene.truth.size());
  for (const std::size_t i : order) {
    const Detection& detection = result.detections[i];
    JudgedDetection judged;
    judged.detection = i;
    const auto same_model = [&](const TruthInstance& truth) {
      return truth.model == detection.model;
    };
    if (std::any_of(scene.truth.begin(), scene.truth.end(), same_model)) {
      const Result<Target*> target = targets.find(detection.model);
      if (!target) return target.error();
      if (const std::optional<Match> match = best_match(**target, detection, scene, found)) {
        const TruthInstance& truth = scene.truth[match->truth];
        found[match->truth] = true;
        judged.truth = match->truth;
        judged.verdict = counts(truth) ? Verdict::right : Verdict::neutral;
        judged.translation_error = match->error.translation;
        judged.rotation_error_deg = match->error.rotation_deg;
        judged.add_right = (*target)->add_right(detection.T_scene_model, truth.T_scene_model);
      }
    }
    if (!judged.truth && !is_scored(detection.model)) judged.verdict = Verdict::neutral;
    out.detections.push_back(judged);
  }
  for (std::size_t t = 0; t < scene.truth.size(); ++t) {
    if (counts(scene.truth[t]) && !found[t]) out.missed.push_back(t);
  }
  return out;
}

}  // namespace

double Tally::recall() const noexcept {
  return instances == 0 ? 0 : static_cast<double>(right) / static_cast<double>(instances);
}

std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) noexcept {
  if (trials == 0) return {0, 1};
  constexpr double z = 1.959963984540054;
  const auto n = static_cast<double>(trials);
  const double p = static_cast<double>(successes) / n;
  const double middle = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  // At the ends the bound is exact; rounding must not move it.
  return {successes == 0 ? 0 : middle - half, successes == trials ? 1 : middle + half};
}

Result<Evaluation> evaluate(const Manifest& manifest, const Library& library,
                            std::span<const std::optional<SceneResult>> results) {
  assert(results.size() == manifest.scenes.size() && "one result, or none, for each scene");
  Evaluation out;
  const std::vector<std::string> scored = scored_models(manifest);
  std::map<std::string, Tally> models;
  std::array<Tally, kOcclusionBins.size() + 1> bins;
  std::vector<double> translation_errors, rotation_errors;
  Targets targets(manifest, library);

  for (std::size_t s = 0; s < manifest.scenes.size(); ++s) {
    const ManifestScene& scene = manifest.scenes[s];
    static const SceneResult kNothing;
    Result<SceneEvaluation> judged =
        judge_scene(scene, scored, results[s] ? *results[s] : kNothing, targets);
    if (!judged) return judged.error();
    judged->missing = !results[s];
    out.num_missing += judged->missing ? 1 : 0;

    const auto count = [&](const TruthInstance& truth, auto&& add) {
      for (Tally* tally : {&out.total, &judged->tally, &models[truth.model],
                           &bins[occlusion_bin(truth.occlusion)]}) {
        add(*tally);
      }
    };
    for (const std::size_t t : judged->missed)
      count(scene.truth[t], [](Tally& tally) { ++tally.instances; });
    for (const JudgedDetection& detection : judged->detections) {
      if (detection.verdict == Verdict::right) {
        count(scene.truth[*detection.truth], [&](Tally& tally) {
          ++tally.instances;
          ++tally.right;
          tally.add_right += detection.add_right ? 1 : 0;
        });
        translation_errors.push_back(detection.translation_error);
        rotation_errors.push_back(detection.rotation_error_deg);
      } else if (detection.verdict == Verdict::wrong) {
        const std::string& model = results[s]->detections[detection.detection].model;
        for (Tally* tally : {&out.total, &judged->tally, &models[model]}) ++tally->false_positives;
      }
    }
    out.scenes.push_back(std::move(*judged));
  }

  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    const char* const name = bin < kOcclusionBins.size() ? kOcclusionBins[bin].second : "unknown";
    if (bins[bin].instances > 0) out.by_occlusion.emplace_back(name, bins[bin]);
  }
  for (const std::string& name : scored) {
    if (const auto found = models.find(name); found != models.end())
      out.by_model.emplace_back(*found);
  }
  out.median_translation_error = median(std::move(translation_errors));
  out.median_rotation_error_deg = median(std::move(rotation_errors));
  out.median_seconds = median_times(results);
  return out;
}

}  // namespace trivet
