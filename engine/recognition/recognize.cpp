#include "engine/recognize.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "engine/camera/check_camera.hpp"
#include "engine/recognition/ablate.hpp"
#include "engine/recognition/scene_search.hpp"

namespace trivet {
namespace {

using engine::ModelGroups;
using engine::PreparedScene;
using engine::SceneSearch;

/// Fewer measurements show nothing: the sensor looks at nothing within its range, or is covered.
constexpr std::size_t kFewestPoints = 50;

Result<ModelGroups> group_models(const Library& library, const std::vector<std::string>& wanted) {
  ModelGroups groups;
  if (wanted.empty()) {
    for (std::uint32_t m = 0; m < library.models.size(); ++m) {
      groups[library.models[m].ppf.quantization.distance_step].push_back(m);
    }
  }
  for (const std::string& name : wanted) {
    const auto found = std::find_if(library.models.begin(), library.models.end(),
                                    [&](const Model& model) { return model.name == name; });
    if (found == library.models.end()) {
      return Error{ErrorCode::usage,
                   fmt::format("{}: expected a model named '{}', found none; `trivet library list` "
                               "shows the names",
                               library.file.string(), name)};
    }
    groups[found->ppf.quantization.distance_step].push_back(
        static_cast<std::uint32_t>(found - library.models.begin()));
  }
  return groups;
}

bool is_place(const Eigen::Vector3f& v) { return v.cwiseAbs().maxCoeff() <= 1e9F && v.allFinite(); }

/// A method alone must have been trained for; both together take what there is.
Result<void> check_methods(const Library& library, Method method) {
  const auto refuse = [&](const char* what, const char* name) {
    return Error{ErrorCode::usage,
                 fmt::format("{}: expected a library with {}, found none; train it with --methods "
                             "{}, or recognize with --method fused",
                             library.file.string(), what, name)};
  };
  const bool pairs = std::ranges::any_of(
      library.models, [](const Model& model) { return !model.ppf.entries.empty(); });
  if (library.models.empty()) return {};
  if (method == Method::ppf && !pairs) return refuse("point pairs", "ppf");
  if (method == Method::trisi && library.basis.components.size() == 0)
    return refuse("Tri-Spin-Images", "trisi");
  return {};
}

/// Refuse a scene whose size says that its unit is not the library's.
Result<void> check_sizes(const Library& library, const PreparedScene& scene,
                         const SceneInput& input) {
  Eigen::Array3f low = scene.points[0].array(), high = low;
  for (std::size_t i = 1; i < scene.points.size(); ++i) {
    low = low.min(scene.points[i].array());
    high = high.max(scene.points[i].array());
  }
  const float extent = (high - low).matrix().norm();
  float smallest = std::numeric_limits<float>::infinity(), largest = 0;
  for (const Model& model : library.models) {
    smallest = std::min(smallest, model.diameter);
    largest = std::max(largest, model.diameter);
  }
  if (extent >= 0.05F * smallest && extent <= 500 * largest) return {};
  return Error{ErrorCode::bad_data,
               fmt::format("{}: expected a scene about as large as the models (diameters {:.4g} to "
                           "{:.4g} {}), found "
                           "an extent of {:.4g}; if the scene's unit differs, give --unit",
                           input.file.string(), smallest, largest,
                           library.header.unit == LengthUnit::meter ? "m" : "mm", extent)};
}

Pose in_file_unit(Pose pose, double scene_scale) {
  pose.translation() /= static_cast<float>(scene_scale);
  return pose;
}

kernels::SensorModel in_file_unit(kernels::SensorModel sensor, double scene_scale) {
  for (float* const length : {&sensor.range, &sensor.noise, &sensor.correlated_noise.height})
    *length /= static_cast<float>(scene_scale);
  return sensor;
}

/// A candidate as its user sees it, in the scene file's unit.
Detection report(const Library& library, const engine::Candidate& candidate, double scene_scale) {
  const Model& model = library.models[candidate.model];
  const kernels::Examination& e = candidate.examination;
  const float seen = e.consistent + e.violation + e.background;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  Detection detection;
  detection.model = model.name;
  detection.source = candidate.source;
  detection.score = candidate.score;
  detection.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
  detection.visible_fraction = e.covered > 0 ? e.consistent / e.covered : 0;
  detection.violation = seen > 0 ? e.violation / seen : 0;
  detection.contour = outline > 0 ? 1 - e.outline_crossed / outline : 1;
  detection.rmse = std::sqrt(e.residual) * candidate.tolerance / static_cast<float>(scene_scale);
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

/// What was rejected, as its user sees it.
///
/// chosen  as they are reported
/// order   indices of `chosen`, one a detection
std::vector<RejectedPose> report_rejected(const Library& library, const SceneSearch& search,
                                          std::span<const engine::Candidate> chosen,
                                          std::span<const std::size_t> order,
                                          std::uint32_t max_rejected, double scene_scale) {
  const std::vector<std::uint32_t>& taken = search.selection().chosen;
  std::vector<RejectedPose> out;
  for (const engine::RejectedCandidate& refusal : engine::best_refused(
           library, search.candidates(), search.selection().refused, chosen, max_rejected)) {
    const engine::Candidate& candidate = search.candidates()[refusal.candidate];
    RejectedPose rejected;
    rejected.model = library.models[candidate.model].name;
    rejected.score = candidate.score;
    rejected.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
    rejected.parts = candidate.parts;
    rejected.reason = refusal.reason;
    for (std::size_t d = 0; d < order.size(); ++d) {
      if (refusal.explained_by != taken[order[d]]) continue;
      rejected.explained_by = d;
      rejected.explained_share = refusal.explained_share;
    }
    out.push_back(std::move(rejected));
  }
  return out;
}

/// Candidates that were taken: chosen, or one too many of their model.
std::vector<std::uint32_t> taken_of(const engine::Selection& selection) {
  std::vector<std::uint32_t> taken = selection.chosen;
  for (const engine::RejectedCandidate& refusal : selection.refused) {
    if (refusal.reason == Rejection::too_many) taken.push_back(refusal.candidate);
  }
  return taken;
}

SceneClaims report_claims(const Library& library, const PreparedScene& scene,
                          const SceneSearch& search, std::span<const std::uint32_t> taken,
                          const RecognizeOptions& options) {
  SceneClaims claims{engine::sizes_of(scene), {}};
  for (const std::uint32_t c : taken) {
    const engine::Candidate& candidate = search.candidates()[c];
    const Model& model = library.models[candidate.model];
    PoseClaim claim{model.name, engine::rank_of(model, candidate, options), {}};
    if (!options.ablated.contains(Improvement::explained)) claim.explained = candidate.explained;
    claims.poses.push_back(std::move(claim));
  }
  return claims;
}

}  // namespace

Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& cloud,
                              const SceneInput& input, const RecognizeOptions& asked,
                              std::stop_token stop) {
  if (const Result<void> valid = validate(asked); !valid) return valid.error();
  if (input.viewpoint && !is_place(*input.viewpoint))
    return Error{ErrorCode::usage, "viewpoint: expected three numbers of at most 1e9"};
  const RecognizeOptions options = engine::ablate(asked);
  const Library& library = recognizer.library();
  if (const Result<void> trained = check_methods(library, options.method); !trained)
    return trained.error();
  Result<ModelGroups> groups = group_models(library, options.models);
  if (!groups) return groups.error();

  SceneResult result;
  SceneStats& stats = result.stats;
  stats.num_points = cloud.points.size();
  stats.num_invalid = cloud.num_invalid;
  if (options.tell_claims) result.claims = SceneClaims{};
  if (cloud.points.size() < kFewestPoints && cloud.triangles.empty()) return result;
  const auto start = std::chrono::steady_clock::now();
  Result<PreparedScene> scene = engine::prepare_scene(cloud, input, stats.times, options);
  if (!scene) return scene.error();
  if (const Result<void> sizes = check_sizes(library, *scene, input); !sizes) return sizes.error();

  SceneSearch search(recognizer, *scene, *groups, options, stop, stats);
  if (!options.expected.empty()) {
    if (const Result<void> tested = search.test_expected(); !tested) return tested.error();
  }
  for (std::uint32_t round = 0; round < options.pose.rounds; ++round) {
    if (const Result<void> done = search.search(round); !done) return done.error();
  }
  // As they were chosen: alternatives change scores, and move poses.
  const std::vector<std::uint32_t> taken = taken_of(search.selection());
  if (options.tell_claims) result.claims = report_claims(library, *scene, search, taken, options);
  const Result<std::vector<engine::Candidate>> chosen = search.chosen();
  if (!chosen) return chosen.error();
  std::vector<std::size_t> order(chosen->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (*chosen)[a].score > (*chosen)[b].score;
  });
  for (const std::size_t c : order)
    result.detections.push_back(report(library, (*chosen)[c], input.scale));
  for (std::size_t d = 0; options.tell_claims && d < order.size(); ++d) {
    const std::uint32_t candidate = search.selection().chosen[order[d]];
    const auto claim = std::ranges::find(taken, candidate) - taken.begin();
    result.claims->poses[static_cast<std::size_t>(claim)].detection = d;
  }
  if (options.max_rejected > 0) {
    result.rejected =
        report_rejected(library, search, *chosen, order, options.max_rejected, input.scale);
  }
  if (cloud.camera && scene->images.size() == 1) {
    const StageTimer timer(stats.times, "check camera");
    stats.camera_check = engine::check_camera(recognizer, *scene, *cloud.camera, *chosen);
  }
  stats.noise = scene->sensor.noise;
  if (scene->images.size() == 1) stats.sensor = in_file_unit(scene->sensor, input.scale);
  stats.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace trivet
