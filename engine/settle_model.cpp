#include "engine/settle_model.hpp"

#include <algorithm>
#include <numeric>

#include "engine/parallel.hpp"
#include "kernels/pose_math.hpp"
#include "kernels/refine_pose.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kFirstLookSamples =
    300;  // samples of the cheap verification before refinement
constexpr std::size_t kRefineSamples = 500;
constexpr std::size_t kContourShare = 3;  // contours judged per candidate refined

kernels::ModelSamples samples_of(const Model& model) {
  return {model.samples,        model.sample_normals, model.sample_views,
          model.sample_spacing, model.diameter,       model.centre};
}

/// Indices of candidates by falling score, ties by index, with a limit per place.
std::vector<std::uint32_t> best_spread(std::span<const Candidate> candidates, const Model& model,
                                       const PoseOptions& options) {
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

}  // namespace

std::vector<Candidate> settle_model(const Library& library, std::uint32_t model_index,
                                    const PreparedScene& scene, float step,
                                    std::span<const kernels::Hypothesis> hypotheses,
                                    const RecogniseOptions& options, SceneStats& stats) {
  const Model& model = library.models[model_index];
  const kernels::ModelSamples samples = samples_of(model);
  const std::vector<std::uint8_t> background = background_planes(scene, model.diameter);

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
  std::vector<Candidate> looked(clusters.size());
  {
    const StageTimer timer(stats.times, "preselect");
    kernels::VerifyOptions loose;
    loose.tolerance = std::max(0.75F * step, 3 * scene.noise);
    loose.plane_is_background = background;
    for_chunks(clusters.size(), 8, [&](std::size_t first, std::size_t count) {
      for (std::size_t c = first; c < first + count; ++c) {
        looked[c].T_scene_model = clusters[c].T_scene_model;
        looked[c].evidence = kernels::verify_pose(scene.images, samples, kFirstLookSamples,
                                                  clusters[c].T_scene_model, loose);
        looked[c].score = looked[c].evidence.score();
      }
    });
    // The contour only lowers a score, and costs more: it is judged for those that are in the
    // running.
    std::stable_sort(looked.begin(), looked.end(),
                     [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
    looked.resize(std::min<std::size_t>(looked.size(), kContourShare * options.pose.max_refined));
    PerThread<kernels::ContourScratch> scratch;
    for_chunks(looked.size(), 4, [&](std::size_t first, std::size_t count) {
      for (std::size_t c = first; c < first + count; ++c) {
        kernels::judge_contour(scene.images, samples, looked[c].T_scene_model, loose,
                               scratch.local(), looked[c].evidence);
        looked[c].score = looked[c].evidence.score();
      }
    });
  }
  const std::vector<std::uint32_t> chosen = best_spread(looked, model, options.pose);
  stats.num_refined += chosen.size();

  std::vector<Candidate> candidates(chosen.size());
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
    for_chunks(chosen.size(), 1, [&](std::size_t first, std::size_t count) {
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
    PerThread<kernels::ContourScratch> scratch;
    for_chunks(candidates.size(), 1, [&](std::size_t first, std::size_t count) {
      for (std::size_t k = first; k < first + count; ++k) {
        Candidate& candidate = candidates[k];
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

}  // namespace trivet::engine
