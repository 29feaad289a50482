#include "engine/recognise.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "engine/check_range.hpp"
#include "engine/parallel.hpp"
#include "engine/prepare_scene.hpp"
#include "engine/select_detections.hpp"
#include "kernels/cluster_poses.hpp"
#include "kernels/pose_math.hpp"
#include "kernels/refine_pose.hpp"
#include "kernels/scene_pairs.hpp"
#include "kernels/verify_pose.hpp"
#include "kernels/vote.hpp"

namespace trivet {
namespace {

using engine::PreparedScene;
using engine::SceneLevel;

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kMaxPairs = 8000;  // of one reference, so that 16-bit counters hold
constexpr std::size_t kFirstLookSamples =
    300;  // samples of the cheap verification before refinement
constexpr std::size_t kRefineSamples = 500;
constexpr std::size_t kContourShare = 3;  // contours judged per candidate refined

/// Models of one sampling step: they share the sampled scene and its pair features.
using ModelGroups = std::map<float, std::vector<std::uint32_t>>;

kernels::ModelSamples samples_of(const Model& model) {
  return {model.samples,        model.sample_normals, model.sample_views,
          model.sample_spacing, model.diameter,       model.centre};
}

/// What each thread needs to vote; nothing in it outlives one reference point.
struct VoteScratch {
  explicit VoteScratch(std::size_t num_points) : pairs(num_points) {}
  std::vector<std::uint32_t> indices;
  Points points;
  Normals normals;
  kernels::PairScratch pairs;
  std::vector<std::uint64_t> keys;
  std::vector<kernels::SceneVote> votes;
  Column<std::uint16_t> accumulator;
  std::uint64_t num_pairs = 0, num_votes = 0;
};

void gather_neighbours(const SceneLevel& level, const Eigen::Vector3f& centre, float radius,
                       VoteScratch& scratch) {
  scratch.indices.clear();
  level.grid.visit_within(centre, radius,
                          [&](std::uint32_t i, float) { scratch.indices.push_back(i); });
  const std::size_t step = 1 + scratch.indices.size() / kMaxPairs;
  const std::size_t n = (scratch.indices.size() + step - 1) / step;
  scratch.points.resize(n);
  scratch.normals.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    scratch.points.set(k, level.points[scratch.indices[k * step]]);
    scratch.normals.set(k, level.normals[scratch.indices[k * step]]);
  }
}

/// Every reference point votes for every model of the group: hypotheses per model, in the order of
/// the references.
std::vector<std::vector<kernels::Hypothesis>> vote_for_models(const Library& library,
                                                              const SceneLevel& level,
                                                              std::span<const std::uint32_t> models,
                                                              const VoteOptions& options,
                                                              SceneStats& stats) {
  // The largest table's quantisation serves all: keys of equal step differ only in how far they
  // reach.
  PpfQuantisation quantisation;
  for (const std::uint32_t m : models) {
    const PpfQuantisation& own = library.models[m].ppf.quantisation;
    if (own.num_distance_bins > quantisation.num_distance_bins) quantisation = own;
  }
  const float radius =
      quantisation.distance_step * static_cast<float>(quantisation.num_distance_bins);

  const std::size_t slots = models.size() * options.max_peaks;
  std::vector<kernels::Hypothesis> found(level.references.size() * slots);
  engine::PerThread<VoteScratch> per_thread(
      [&] { return VoteScratch(std::min(level.points.size(), kMaxPairs + 1)); });
  engine::for_chunks(level.references.size(), 4, [&](std::size_t first, std::size_t count) {
    VoteScratch& scratch = per_thread.local();
    for (std::size_t r = first; r < first + count; ++r) {
      const std::uint32_t i = level.references[r];
      const kernels::ReferenceFrame frame =
          kernels::reference_frame(level.points[i], level.normals[i]);
      gather_neighbours(level, frame.point, radius, scratch);
      kernels::collect_scene_votes(frame, scratch.points, scratch.normals, quantisation,
                                   options.neighbour_share, scratch.pairs, scratch.keys,
                                   scratch.votes);
      if (scratch.votes.size() > kMaxPairs) scratch.votes.resize(kMaxPairs);
      scratch.num_pairs += scratch.points.size();
      const Pose T_scene_frame = kernels::frame_pose(frame).inverse();
      for (std::size_t m = 0; m < models.size(); ++m) {
        const Model& model = library.models[models[m]];
        scratch.accumulator.resize(model.ppf.num_references * kernels::kRotationBins);
        scratch.num_votes +=
            kernels::cast_votes(scratch.votes, model.ppf, options.max_votes, scratch.accumulator);
        const kernels::VotePeaks peaks =
            kernels::take_peaks(scratch.accumulator, options.max_peaks, options.peak_share);
        for (std::size_t k = 0; k < peaks.count; ++k) {
          const kernels::VotePeak& peak = peaks.peak[k];
          Pose turn = Pose::Identity();
          turn.linear() =
              Eigen::AngleAxisf(peak.rotation_rad, Eigen::Vector3f::UnitX()).toRotationMatrix();
          const Pose T_frame_model = kernels::frame_pose(kernels::reference_frame(
              model.ppf_points[peak.model_point], model.ppf_normals[peak.model_point]));
          found[r * slots + m * options.max_peaks + k] = {T_scene_frame * turn * T_frame_model,
                                                          static_cast<float>(peak.votes)};
        }
      }
    }
  });
  for (const VoteScratch& scratch : per_thread) {
    stats.num_pairs += scratch.num_pairs;
    stats.num_votes += scratch.num_votes;
  }
  stats.num_references += level.references.size();

  std::vector<std::vector<kernels::Hypothesis>> hypotheses(models.size());
  for (std::size_t slot = 0; slot < found.size(); ++slot) {
    if (found[slot].votes > 0) hypotheses[slot % slots / options.max_peaks].push_back(found[slot]);
  }
  return hypotheses;
}

/// Indices of candidates by falling score, ties by index, with a limit per place.
std::vector<std::uint32_t> best_spread(std::span<const engine::Candidate> candidates,
                                       const Model& model, const PoseOptions& options) {
  std::vector<std::uint32_t> order(candidates.size()), chosen;
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return candidates[a].score > candidates[b].score;
  });
  const float place = 0.2F * model.diameter;
  std::vector<Eigen::Vector3f> centres;
  for (const std::uint32_t c : order) {
    if (chosen.size() == options.max_refined || !(candidates[c].score > 0)) break;
    const Eigen::Vector3f centre = candidates[c].T_scene_model * model.centre;
    const auto near = std::count_if(
        centres.begin(), centres.end(),
        [&](const Eigen::Vector3f& other) { return (other - centre).norm() < place; });
    if (near >= static_cast<std::ptrdiff_t>(options.max_per_place)) continue;
    chosen.push_back(c);
    centres.push_back(centre);
  }
  return chosen;
}

/// From the hypotheses of one model to verified candidates.
std::vector<engine::Candidate> settle_model(const Library& library, std::uint32_t model_index,
                                            const PreparedScene& scene, float step,
                                            std::span<const kernels::Hypothesis> hypotheses,
                                            const RecogniseOptions& options, SceneStats& stats) {
  const Model& model = library.models[model_index];
  const kernels::ModelSamples samples = samples_of(model);
  const std::vector<std::uint8_t> background = engine::background_planes(scene, model.diameter);

  std::vector<kernels::Hypothesis> clusters;
  {
    const StageTimer timer(stats.times, "cluster");
    const kernels::ClusterOptions cluster_options{
        options.pose.cluster_translation * model.diameter,
        options.pose.cluster_rotation_deg * kRadiansPerDegree, options.pose.max_clusters};
    clusters = kernels::cluster_poses(hypotheses, model.symmetry, model.centre, cluster_options);
  }
  stats.num_hypotheses += clusters.size();

  // A first look with the tolerance of an unrefined pose, to choose which ones to refine.
  std::vector<engine::Candidate> looked(clusters.size());
  {
    const StageTimer timer(stats.times, "preselect");
    kernels::VerifyOptions loose;
    loose.tolerance = std::max(0.75F * step, 3 * scene.noise);
    loose.plane_is_background = background;
    engine::for_chunks(clusters.size(), 8, [&](std::size_t first, std::size_t count) {
      for (std::size_t c = first; c < first + count; ++c) {
        looked[c].T_scene_model = clusters[c].T_scene_model;
        looked[c].evidence = kernels::verify_pose(scene.images, samples, kFirstLookSamples,
                                                  clusters[c].T_scene_model, loose);
        looked[c].score = looked[c].evidence.score();
      }
    });
    // The contour only lowers a score, and costs more: it is judged for those that are in the
    // running.
    std::stable_sort(
        looked.begin(), looked.end(),
        [](const engine::Candidate& a, const engine::Candidate& b) { return a.score > b.score; });
    looked.resize(std::min<std::size_t>(looked.size(), kContourShare * options.pose.max_refined));
    engine::PerThread<kernels::ContourScratch> scratch;
    engine::for_chunks(looked.size(), 4, [&](std::size_t first, std::size_t count) {
      for (std::size_t c = first; c < first + count; ++c) {
        kernels::judge_contour(scene.images, samples, looked[c].T_scene_model, loose,
                               scratch.local(), looked[c].evidence);
        looked[c].score = looked[c].evidence.score();
      }
    });
  }
  const std::vector<std::uint32_t> chosen = best_spread(looked, model, options.pose);
  stats.num_refined += chosen.size();

  std::vector<engine::Candidate> candidates(chosen.size());
  kernels::VerifyOptions strict;
  strict.tolerance = std::max(options.verify.tolerance_sigmas * scene.noise,
                              options.verify.tolerance_diameters * model.diameter);
  strict.plane_is_background = background;
  {
    const StageTimer timer(stats.times, "refine");
    kernels::RefineOptions refine;
    refine.num_samples = kRefineSamples;
    refine.first_gate = std::max(1.5F * step, 2 * strict.tolerance);
    refine.last_gate = strict.tolerance;
    refine.max_translation = 0.1F * model.diameter;
    engine::for_chunks(chosen.size(), 1, [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        candidates[k].model = model_index;
        candidates[k].T_scene_model =
            kernels::refine_pose(scene.images, samples, looked[chosen[k]].T_scene_model, refine)
                .T_scene_model;
      }
    });
  }
  {
    const StageTimer timer(stats.times, "verify");
    engine::PerThread<kernels::ContourScratch> scratch;
    engine::for_chunks(candidates.size(), 1, [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        engine::Candidate& candidate = candidates[k];
        candidate.evidence =
            kernels::verify_pose(scene.images, samples, samples.points.size(),
                                 candidate.T_scene_model, strict, &candidate.explained);
        kernels::judge_contour(scene.images, samples, candidate.T_scene_model, strict,
                               scratch.local(), candidate.evidence);
        candidate.score = candidate.evidence.score();
      }
    });
  }
  return candidates;
}

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
      hypotheses = vote_for_models(library, level, models, options.vote, stats);
    }
    for (std::size_t m = 0; m < models.size(); ++m) {
      if (stop.stop_requested()) return Error{ErrorCode::resumable, "stopped on request"};
      std::vector<engine::Candidate> settled =
          settle_model(library, models[m], *scene, step, hypotheses[m], options, stats);
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
