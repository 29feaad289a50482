#include "engine/recognise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/check_range.hpp"
#include "engine/find_hypotheses.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/select_detections.hpp"
#include "engine/settle_model.hpp"
#include "kernels/vote.hpp"

namespace trivet {
namespace {

using engine::PreparedScene;
using engine::SceneLevel;

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

}  // namespace

Result<SceneResult> recognise(const Library& library, const Cloud& cloud, const SceneInput& input,
                              const RecogniseOptions& options, std::stop_token stop) {
  if (const Result<void> valid = validate(options); !valid) return valid.error();
  Result<ModelGroups> groups = group_models(library, options.models);
  if (!groups) return groups.error();

  SceneResult result;
  SceneStats& stats = result.stats;
  const auto start = std::chrono::steady_clock::now();
  Result<PreparedScene> scene = engine::prepare_scene(cloud, input, stats.times);
  if (!scene) return scene.error();
  if (const Result<void> sizes = check_sizes(library, *scene, input); !sizes) return sizes.error();

  std::vector<engine::Candidate> candidates;
  for (const auto& [step, models] : *groups) {
    float largest = 0;
    for (const std::uint32_t m : models) largest = std::max(largest, library.models[m].diameter);
    std::vector<std::vector<kernels::Hypothesis>> hypotheses;
    SceneLevel level;
    {
      const StageTimer timer(stats.times, "subsample");
      level = engine::sample_scene(*scene, step, largest, options.vote);
    }
    {
      const StageTimer timer(stats.times, "vote");
      hypotheses = engine::find_hypotheses(library, level, models, options.vote, stats);
    }
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (stop.stop_requested()) return Error{ErrorCode::resumable, "stopped on request"};
      std::vector<engine::Candidate> settled =
          engine::settle_model(library, models[m], *scene, step, hypotheses[m], options, stats);
      std::move(settled.begin(), settled.end(), std::back_inserter(candidates));
    }
  }
  {
    const StageTimer timer(stats.times, "select");
    result.detections =
        engine::select_detections(library, *scene, std::move(candidates), options, input.scale);
  }
  stats.num_points = cloud.points.size();
  stats.num_invalid = cloud.num_invalid;
  stats.noise = scene->noise;
  stats.total_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

Result<void> validate(const RecogniseOptions& options) {
  return engine::check_ranges({
      {options.vote.reference_share > 0 && options.vote.reference_share <= 1, "reference share",
       "above 0 to 1", options.vote.reference_share},
      {options.vote.max_references > 0, "maximum references", "at least 1",
       static_cast<double>(options.vote.max_references)},
      {options.vote.max_votes > 0, "maximum votes", "at least 1",
       static_cast<double>(options.vote.max_votes)},
      {options.vote.peak_share > 0 && options.vote.peak_share <= 1, "peak share", "above 0 to 1",
       options.vote.peak_share},
      {options.pose.cluster_translation > 0, "cluster translation [diameters]", "above 0",
       options.pose.cluster_translation},
      {options.pose.cluster_rotation_deg > 0, "cluster rotation [deg]", "above 0",
       options.pose.cluster_rotation_deg},
      {options.verify.tolerance_diameters > 0, "tolerance [diameters]", "above 0",
       options.verify.tolerance_diameters},
      {options.verify.max_overlap >= 0 && options.verify.max_overlap <= 1, "maximum overlap",
       "0 to 1", options.verify.max_overlap},
      {options.vote.neighbour_share >= 0 && options.vote.neighbour_share <= 0.5F, "neighbour share",
       "0 to 0.5", options.vote.neighbour_share},
      {options.vote.max_peaks >= 1 && options.vote.max_peaks <= kernels::kMaxPeaks,
       "peaks per reference", "1 to 8", static_cast<double>(options.vote.max_peaks)},
      {options.min_score >= 0 && options.min_score <= 1, "minimum score", "0 to 1",
       options.min_score},
      {options.doubtful_score.value_or(0) >= 0 && options.doubtful_score.value_or(0) <= 1,
       "doubtful score", "0 to 1", options.doubtful_score.value_or(0)},
  });
}

}  // namespace trivet
