#include "engine/recognise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "engine/check_range.hpp"
#include "engine/find_hypotheses.hpp"
#include "engine/leave_out.hpp"
#include "engine/match_features.hpp"
#include "engine/parallel.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/select_detections.hpp"
#include "engine/settle_model.hpp"
#include "engine/settle_rivals.hpp"
#include "kernels/vote.hpp"

namespace trivet {
namespace {

using engine::PreparedScene;
using engine::SceneLevel;

/// Fewer measurements show nothing: the sensor looks at nothing within its range, or is covered.
constexpr std::size_t kFewestPoints = 50;

/// Models of one sampling step: they share the sampled scene and its pair features.
using ModelGroups = std::map<float, std::vector<std::uint32_t>>;

Result<ModelGroups> group_models(const Library& library, const std::vector<std::string>& wanted) {
  ModelGroups groups;
  if (wanted.empty()) {
    for (std::uint32_t m = 0; m < library.models.size(); ++m) {
      groups[library.models[m].ppf.quantisation.distance_step].push_back(m);
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
    groups[found->ppf.quantisation.distance_step].push_back(
        static_cast<std::uint32_t>(found - library.models.begin()));
  }
  return groups;
}

Result<void> validate(const VoteOptions& options) {
  return engine::check_ranges({
      {options.radius > 0 && options.radius <= 1, "radius of pairs [diameters]", "above 0 to 1",
       options.radius},
      {options.reference_share > 0 && options.reference_share <= 1, "reference share",
       "above 0 to 1", options.reference_share},
      {options.max_references > 0, "maximum references", "at least 1",
       static_cast<double>(options.max_references)},
      {options.max_votes > 0, "maximum votes", "at least 1",
       static_cast<double>(options.max_votes)},
      {options.peak_share > 0 && options.peak_share <= 1, "peak share", "above 0 to 1",
       options.peak_share},
      {options.neighbour_share >= 0 && options.neighbour_share <= 0.5F, "neighbour share",
       "0 to 0.5", options.neighbour_share},
      {options.max_peaks >= 1 && options.max_peaks <= kernels::kMaxPeaks, "peaks per reference",
       "1 to 8", static_cast<double>(options.max_peaks)},
  });
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
                           library.header.unit == LengthUnit::metre ? "m" : "mm", extent)};
}

/// Only references whose model could lie within the limits vote.
void drop_far_references(const PoseLimits& limits, const PreparedScene& scene, float reach,
                         SceneLevel& level) {
  if (!limits.region) return;
  const auto scale = static_cast<float>(scene.scale);
  const Eigen::Array3f low = limits.region->low.array() * scale - reach;
  const Eigen::Array3f high = limits.region->high.array() * scale + reach;
  std::erase_if(level.references, [&](std::uint32_t i) {
    const Eigen::Array3f p = level.points[i].array();
    return !((p >= low).all() && (p <= high).all());
  });
}

/// The search of one scene: candidates from expected poses and rounds of voting, and the choice
/// among all of them.
class SceneSearch {
 public:
  SceneSearch(const Recogniser& recogniser, const PreparedScene& scene,
              const RecogniseOptions& options, const std::stop_token& stop, SceneStats& stats)
      : recogniser_(recogniser),
        library_(recogniser.library()),
        scene_(scene),
        options_(options),
        stop_(stop),
        stats_(stats) {}

  Result<void> test_expected(const ModelGroups& groups) {
    for (const auto& [step, models] : groups) {
      for (const std::uint32_t m : models) {
        std::vector<kernels::Hypothesis> hypotheses;
        for (const ExpectedPose& expected : options_.expected) {
          if (expected.model != library_.models[m].name) continue;
          hypotheses.push_back({expected.T_scene_model, 1});
          hypotheses.back().T_scene_model.translation() *= static_cast<float>(scene_.scale);
        }
        if (hypotheses.empty()) continue;
        if (const Result<void> settled = settle(m, step, hypotheses); !settled) return settled;
      }
    }
    select();
    return {};
  }

  /// Vote for what is not yet explained.
  Result<void> vote(const ModelGroups& groups, std::uint32_t round) {
    const VoteOptions& options = round == 0 ? options_.vote : options_.later;
    const std::vector<std::pair<float, std::vector<std::uint32_t>>> sizes(groups.begin(),
                                                                          groups.end());
    std::vector<SceneLevel> levels(sizes.size());
    {
      const StageTimer timer(stats_.times, "subsample");
      samples_.resize(sizes.size());
      engine::for_each_index(sizes.size(), [&](std::size_t k) {
        if (round == 0) samples_[k] = sample(sizes[k].first, sizes[k].second);
        levels[k] = engine::choose_voters(scene_, samples_[k], options, selection_.explained);
        drop_far_references(options_.limits, scene_, samples_[k].largest_diameter, levels[k]);
      });
    }
    for (std::size_t k = 0; k < sizes.size(); ++k) {
      const auto& [step, models] = sizes[k];
      std::vector<std::vector<kernels::Hypothesis>> hypotheses;
      {
        const StageTimer timer(stats_.times, "vote");
        hypotheses = engine::find_hypotheses(library_, levels[k], models, options, stats_);
      }
      for (std::size_t m = 0; m < models.size(); ++m) {
        const Result<void> settled = settle(models[m], step, hypotheses[m]);
        if (!settled) return settled;
      }
    }
    select();
    return {};
  }

  /// Match the scene's features with those of the models.
  Result<void> match(const ModelGroups& groups) {
    const Result<engine::FeatureLibrary>& features = recogniser_.features();
    if (!features) return features.error();
    std::vector<bool> wanted(library_.models.size(), false);
    for (const auto& [step, models] : groups) {
      for (const std::uint32_t m : models) wanted[m] = true;
    }
    std::vector<std::uint32_t> all(library_.models.size());
    std::iota(all.begin(), all.end(), 0U);
    for (const engine::FeatureLevel& level : features->levels) {
      if (std::ranges::none_of(level.model, [&](std::uint32_t m) { return wanted[m]; })) continue;
      std::vector<std::vector<kernels::Hypothesis>> hypotheses;
      {
        const StageTimer timer(stats_.times, "match");
        hypotheses = engine::match_features(*features, level, sample(level.resolution, all),
                                            library_.models.size(), {});
      }
      for (std::uint32_t m = 0; m < hypotheses.size(); ++m) {
        const Model& model = library_.models[m];
        if (hypotheses[m].empty() || !wanted[m]) continue;
        const Result<void> settled = settle(m, model.ppf.quantisation.distance_step, hypotheses[m]);
        if (!settled) return settled;
      }
    }
    select();
    return {};
  }

  /// The chosen candidates in the order of choice, held against their rivals. Those that move to
  /// where another one lies are refused, and those below the scores that are asked for.
  Result<std::vector<engine::Candidate>> chosen() {
    const std::vector<std::uint32_t> before = std::exchange(selection_.chosen, {});
    Result<std::vector<engine::Candidate>> settled = settle_rivals(before);
    if (!settled) return settled.error();
    std::vector<engine::Candidate> out;
    for (std::size_t k = 0; k < before.size(); ++k) {
      const std::uint32_t c = before[k];
      engine::Candidate& candidate = (*settled)[k];
      if (lies_at_one_of(out, candidate)) {
        selection_.refused.push_back({c, Rejection::explained});
        candidates_[c] = std::move(candidate);
        continue;
      }
      if (candidate.score < options_.doubtful_score.value_or(options_.min_score)) {
        selection_.refused.push_back({c, Rejection::too_low});
        candidates_[c] = std::move(candidate);
        continue;
      }
      selection_.chosen.push_back(c);
      out.push_back(std::move(candidate));
    }
    return out;
  }

  const std::vector<engine::Candidate>& candidates() const noexcept { return candidates_; }
  const engine::Selection& selection() const noexcept { return selection_; }

 private:
  engine::SceneSample sample(float step, std::span<const std::uint32_t> models) const {
    float largest = 0;
    for (const std::uint32_t m : models) largest = std::max(largest, library_.models[m].diameter);
    return engine::sample_scene(scene_, step, largest, options_.without);
  }

  /// Candidates, each held against its rivals.
  Result<std::vector<engine::Candidate>> settle_rivals(std::span<const std::uint32_t> chosen) {
    const StageTimer timer(stats_.times, "rivals");
    std::vector<engine::Candidate> settled(chosen.size());
    std::vector<Result<void>> results(chosen.size());
    engine::for_each_index(chosen.size(), [&](std::size_t k) {
      settled[k] = candidates_[chosen[k]];
      if (options_.without.contains(Improvement::rivals)) return;
      const Model& model = library_.models[settled[k].model];
      results[k] = engine::settle_rivals(recogniser_, scene_, model.ppf.quantisation.distance_step,
                                         candidates_, options_, settled[k]);
    });
    for (const Result<void>& result : results) {
      if (!result) return result.error();
    }
    return settled;
  }

  /// Whether a settled candidate moved to where a better one lies.
  bool lies_at_one_of(std::span<const engine::Candidate> better,
                      const engine::Candidate& candidate) const {
    return std::any_of(better.begin(), better.end(), [&](const engine::Candidate& other) {
      return other.model == candidate.model &&
             engine::same_placement(library_.models[other.model], other.T_scene_model,
                                    candidate.T_scene_model);
    });
  }

  Result<void> settle(std::uint32_t model, float step,
                      std::span<const kernels::Hypothesis> hypotheses) {
    if (stop_.stop_requested()) return Error{ErrorCode::resumable, "stopped on request"};
    Result<std::vector<engine::Candidate>> settled =
        engine::settle_model(recogniser_, model, scene_, step, hypotheses, options_, stats_);
    if (!settled) return settled.error();
    for (engine::Candidate& candidate : *settled) {
      candidate.method = options_.method;
      candidates_.push_back(std::move(candidate));
    }
    return {};
  }

  void select() {
    const StageTimer timer(stats_.times, "select");
    selection_ = engine::select_detections(library_, scene_, candidates_, options_);
  }

  const Recogniser& recogniser_;
  const Library& library_;
  const PreparedScene& scene_;
  const RecogniseOptions& options_;
  const std::stop_token& stop_;
  SceneStats& stats_;
  std::vector<engine::SceneSample> samples_;  // one a group of models, from the first round on
  std::vector<engine::Candidate> candidates_;
  engine::Selection selection_;
};

Pose in_file_unit(Pose pose, double scene_scale) {
  pose.translation() /= static_cast<float>(scene_scale);
  return pose;
}

/// A candidate as its user sees it, in the scene file's unit.
Detection report(const Library& library, const engine::Candidate& candidate, double scene_scale) {
  const Model& model = library.models[candidate.model];
  const kernels::Examination& e = candidate.examination;
  const float seen = e.consistent + e.violation + e.background;
  const float outline = e.outline_free + e.outline_touching + e.outline_crossed;
  Detection detection;
  detection.model = model.name;
  detection.method = candidate.method;
  detection.score = candidate.score;
  detection.T_scene_model = in_file_unit(candidate.T_scene_model, scene_scale);
  detection.visible_fraction = e.covered > 0 ? e.consistent / e.covered : 0;
  detection.violation = seen > 0 ? e.violation / seen : 0;
  detection.contour = outline > 0 ? 1 - e.outline_crossed / outline : 1;
  detection.rmse = std::sqrt(e.residual) * candidate.tolerance / static_cast<float>(scene_scale);
  detection.parts = candidate.parts;
  for (const Pose& rival : candidate.rivals)
    detection.rivals.push_back(in_file_unit(rival, scene_scale));
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
  for (const engine::Refusal& refusal : engine::best_refused(
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

}  // namespace

Result<SceneResult> recognise(const Recogniser& recogniser, const Cloud& cloud,
                              const SceneInput& input, const RecogniseOptions& asked,
                              std::stop_token stop) {
  if (const Result<void> valid = validate(asked); !valid) return valid.error();
  const RecogniseOptions options = engine::leave_out(asked);
  const Library& library = recogniser.library();
  Result<ModelGroups> groups = group_models(library, options.models);
  if (!groups) return groups.error();

  SceneResult result;
  SceneStats& stats = result.stats;
  stats.num_points = cloud.points.size();
  stats.num_invalid = cloud.num_invalid;
  if (cloud.points.size() < kFewestPoints && cloud.triangles.empty()) return result;
  const auto start = std::chrono::steady_clock::now();
  Result<PreparedScene> scene = engine::prepare_scene(cloud, input, stats.times, options.without);
  if (!scene) return scene.error();
  if (const Result<void> sizes = check_sizes(library, *scene, input); !sizes) return sizes.error();

  SceneSearch search(recogniser, *scene, options, stop, stats);
  if (!options.expected.empty()) {
    if (const Result<void> tested = search.test_expected(*groups); !tested) return tested.error();
  }
  for (std::uint32_t round = 0; options.method == Method::ppf && round < options.pose.rounds;
       ++round) {
    if (const Result<void> voted = search.vote(*groups, round); !voted) return voted.error();
  }
  if (options.method == Method::trisi) {
    if (const Result<void> matched = search.match(*groups); !matched) return matched.error();
  }
  const Result<std::vector<engine::Candidate>> chosen = search.chosen();
  if (!chosen) return chosen.error();
  std::vector<std::size_t> order(chosen->size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (*chosen)[a].score > (*chosen)[b].score;
  });
  for (const std::size_t c : order)
    result.detections.push_back(report(library, (*chosen)[c], input.scale));
  if (options.max_rejected > 0) {
    result.rejected =
        report_rejected(library, search, *chosen, order, options.max_rejected, input.scale);
  }
  stats.noise = scene->noise;
  stats.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Result<void> validate(const RecogniseOptions& options) {
  for (const VoteOptions& vote : {options.vote, options.later}) {
    if (const Result<void> valid = validate(vote); !valid) return valid;
  }
  return engine::check_ranges({
      {options.pose.rounds <= 4, "rounds of voting", "0 to 4",
       static_cast<double>(options.pose.rounds)},
      {!options.limits.region ||
           (options.limits.region->low.array() <= options.limits.region->high.array()).all(),
       "region", "a box whose low corner is below its high corner", 0},
      {!options.limits.tilt || (options.limits.tilt->model_direction.norm() > 0 &&
                                options.limits.tilt->scene_direction.norm() > 0 &&
                                options.limits.tilt->max_angle_deg >= 0),
       "tilt", "two directions of any length above 0 and an angle of at least 0", 0},
      {options.pose.cluster_translation > 0, "cluster translation [diameters]", "above 0",
       options.pose.cluster_translation},
      {options.pose.cluster_rotation_deg > 0, "cluster rotation [deg]", "above 0",
       options.pose.cluster_rotation_deg},
      {options.verify.tolerance_diameters > 0, "tolerance [diameters]", "above 0",
       options.verify.tolerance_diameters},
      {options.verify.max_overlap >= 0 && options.verify.max_overlap <= 1, "maximum overlap",
       "0 to 1", options.verify.max_overlap},
      {options.min_score >= 0 && options.min_score <= 1, "minimum score", "0 to 1",
       options.min_score},
      {options.doubtful_score.value_or(0) >= 0 && options.doubtful_score.value_or(0) <= 1,
       "doubtful score", "0 to 1", options.doubtful_score.value_or(0)},
  });
}

}  // namespace trivet
