#include "engine/settle_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "engine/parallel.hpp"
#include "kernels/compare_poses.hpp"
#include "kernels/pose_math.hpp"
#include "kernels/refine_pose.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kFirstLookSamples =
    300;  // samples of the cheap verification before refinement
constexpr std::size_t kRefineSamples = 500;
constexpr std::size_t kContourSamples = 700;
constexpr std::size_t kContourShare = 3;  // contours judged per candidate refined
constexpr float kPlace = 0.2F;            // in diameters
constexpr std::uint32_t kExaminedAPlace = 5;
// Score of a refined pose by samples below which no ray need be shot: of 600 examinations above 0.3
// on the development scans it lost none, of all examinations it saves two thirds.
constexpr float kHopeless = 0.05F;
// The score adds up, so that much agreement could outweigh any violation: of right poses on
// rendered scenes 99 % are looked through by less than 9 % of what is seen, of wrong ones 43 % by
// more than 12.
constexpr float kMostViolation = 0.15F;
constexpr float kSameTranslation = 0.01F;  // in diameters
constexpr float kSameRotationRad = 0.035F;
constexpr float kRivalPlace = 0.3F;  // in diameters
constexpr float kLeastRivalScore = 0.1F;
constexpr float kRivalShare = 0.5F;  // of the score of the pose that is rivalled
constexpr int kMaxHops = 3;          // from rival to better rival
constexpr double kTelling = 0.7;     // in standard deviations; three to one
// Of the noise: waves of real depth cameras are higher than it, what windows leave of independent
// noise is a twentieth.
constexpr float kWavy = 0.25F;

kernels::ModelSamples samples_of(const Model& model) {
  return {model.samples,        model.sample_normals, model.sample_views,
          model.sample_spacing, model.diameter,       model.centre};
}

/// In waves, half a patch of the windows that they are measured in errs alike.
kernels::MeasurementErrors errors_of(const PreparedScene& scene) {
  const int window = 2 * static_cast<int>(std::lround(scene.window)) + 1;
  const bool wavy = scene.waviness.height > kWavy * scene.noise;
  return {std::hypot(scene.noise, scene.waviness.height),
          wavy ? static_cast<int>(kernels::kPatch / 2) * window : 3};
}

/// A pose that was looked at by samples of the surface.
struct Look {
  Pose T_scene_model = Pose::Identity();
  float votes = 0;  // share of the votes for the model
  kernels::Evidence evidence;
  float score = 0;
};

/// Indices by falling score, ties by index.
std::vector<std::uint32_t> by_score(std::span<const Look> looks) {
  std::vector<std::uint32_t> order(looks.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return looks[a].score > looks[b].score;
  });
  return order;
}

/// The best ones above a score, with a limit in all and per place.
std::vector<std::uint32_t> best_spread(std::span<const Look> looks, const Model& model,
                                       float least_score, std::size_t limit,
                                       std::uint32_t limit_a_place) {
  std::vector<std::uint32_t> chosen;
  std::vector<Eigen::Vector3f> centres;
  for (const std::uint32_t c : by_score(looks)) {
    if (chosen.size() == limit || !(looks[c].score > least_score)) break;
    const Eigen::Vector3f centre = looks[c].T_scene_model * model.centre;
    const auto near =
        std::count_if(centres.begin(), centres.end(), [&](const Eigen::Vector3f& other) {
          return (other - centre).norm() < kPlace * model.diameter;
        });
    if (near >= static_cast<std::ptrdiff_t>(limit_a_place)) continue;
    chosen.push_back(c);
    centres.push_back(centre);
  }
  return chosen;
}

/// Leave the best of poses that refinement led to one place.
std::vector<Look> without_repetitions(std::span<const Look> looks, const Model& model) {
  std::vector<Look> kept;
  for (const std::uint32_t c : by_score(looks)) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const Look& other) {
      const kernels::PoseDistance distance = kernels::pose_distance(
          other.T_scene_model, looks[c].T_scene_model, model.symmetry, model.centre);
      return distance.translation < kSameTranslation * model.diameter &&
             distance.rotation_rad < kSameRotationRad;
    });
    if (!known) kept.push_back(looks[c]);
  }
  return kept;
}

/// One model in one scene: what all its stages look at.
class Settling {
 public:
  Settling(const Model& model, const PreparedScene& scene, float step,
           const RecogniseOptions& options, SceneStats& stats)
      : model_(model),
        scene_(scene),
        step_(step),
        options_(options),
        stats_(stats),
        samples_(samples_of(model)),
        background_(left_out(Improvement::background) ? std::vector<std::uint8_t>{}
                                                      : background_planes(scene, model.diameter)) {
    strict_.tolerance = std::max(options.verify.tolerance_sigmas * scene.noise,
                                 options.verify.tolerance_diameters * model.diameter);
    strict_.plane_is_background = background_;
  }

  std::vector<kernels::Hypothesis> cluster(std::span<const kernels::Hypothesis> hypotheses) const {
    const StageTimer timer(stats_.times, "cluster");
    const kernels::ClusterOptions limits{options_.pose.cluster_translation * model_.diameter,
                                         options_.pose.cluster_rotation_deg * kRadiansPerDegree,
                                         options_.pose.max_clusters};
    std::vector<kernels::Hypothesis> clusters =
        kernels::cluster_poses(hypotheses, model_.symmetry, model_.centre, limits);
    std::erase_if(clusters, [&](const kernels::Hypothesis& cluster) {
      return !allowed(cluster.T_scene_model);
    });
    return clusters;
  }

  /// A first look with the tolerance of an unrefined pose chooses which ones to refine.
  ///
  /// num_votes  of all hypotheses of the model
  std::vector<Look> preselect(std::span<const kernels::Hypothesis> clusters,
                              float num_votes) const {
    const StageTimer timer(stats_.times, "preselect");
    kernels::VerifyOptions loose;
    loose.tolerance = std::max(0.75F * step_, 3 * scene_.noise);
    loose.plane_is_background = background_;
    std::vector<Look> looks(clusters.size());
    for_each_index(clusters.size(), [&](std::size_t c) {
      looks[c].T_scene_model = clusters[c].T_scene_model;
      looks[c].votes = clusters[c].votes / num_votes;
      look_at(kFirstLookSamples, loose, looks[c]);
    });
    // The contour only lowers a score, and costs more: it is judged for those that are in the
    // running.
    std::vector<Look> running;
    for (const std::uint32_t c : by_score(looks)) {
      if (running.size() == kContourShare * options_.pose.max_refined) break;
      running.push_back(looks[c]);
    }
    judge_contours(loose, running);
    std::vector<Look> best;
    for (const std::uint32_t c : by_score(running)) {
      if (best.size() == options_.pose.max_refined || !(running[c].score > 0)) break;
      best.push_back(running[c]);
    }
    return best;
  }

  std::vector<Look> refine(std::vector<Look> looks) const {
    {
      const StageTimer timer(stats_.times, "refine");
      const kernels::RefineOptions sparse = sparse_refinement();
      for_each_index(looks.size(), [&](std::size_t k) {
        looks[k].T_scene_model = refined(looks[k].T_scene_model, sparse);
      });
    }
    const StageTimer timer(stats_.times, "verify");
    for_each_index(looks.size(),
                   [&](std::size_t k) { look_at(samples_.points.size(), strict_, looks[k]); });
    judge_contours(strict_, looks);
    looks = without_repetitions(looks, model_);
    std::vector<Look> best;
    const float hopeless = left_out(Improvement::visibility) ? 0 : kHopeless;
    for (const std::uint32_t c :
         best_spread(looks, model_, hopeless, options_.pose.max_examined, kExaminedAPlace)) {
      best.push_back(looks[c]);
    }
    return best;
  }

  /// Refine once more with all samples, and test by rays.
  std::vector<Candidate> examine_all(const kernels::RayScene& surface,
                                     const kernels::ScoreModel& score,
                                     std::span<const Look> looks) const {
    const StageTimer timer(stats_.times, "examine");
    std::vector<Candidate> candidates(looks.size());
    PerThread<kernels::ExamineScratch> scratch;
    for_each_index(looks.size(), [&](std::size_t k) {
      candidates[k] = left_out(Improvement::rays)
                          ? judged_by_samples(looks[k])
                          : examine(surface, score, looks[k].T_scene_model, scratch.local());
    });
    std::erase_if(candidates,
                  [&](const Candidate& candidate) { return !allowed(candidate.T_scene_model); });
    return candidates;
  }

  void settle_rivals(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                     std::span<const Candidate> candidates, Candidate& candidate) const {
    const StageTimer timer(stats_.times, "rivals");
    kernels::ExamineScratch examine_scratch;
    kernels::CompareScratch compare_scratch;
    const kernels::MeasurementErrors errors = errors_of(scene_);
    std::vector<Pose> alike;
    for (int hop = 0; hop <= kMaxHops; ++hop) {
      alike.clear();
      std::optional<Pose> better;
      double most = 0;
      for (const Pose& rival : rivals_of(candidate, candidates)) {
        const kernels::PoseComparison comparison =
            kernels::compare_poses(scene_.images, surface, samples_, rival, candidate.T_scene_model,
                                   errors, strict_, compare_scratch);
        if (comparison.log_ratio > most && comparison.z > kTelling) {
          most = comparison.log_ratio;
          better = rival;
        }
        if (!comparison.significant()) alike.push_back(rival);
      }
      if (!better || hop == kMaxHops) break;
      Candidate moved = examine(surface, score, *better, examine_scratch);
      if (moved.score < kRivalShare * candidate.score) break;
      moved.model = candidate.model;
      candidate = std::move(moved);
    }
    for (const Pose& other : alike) {
      const Candidate rival = examine(surface, score, other, examine_scratch);
      if (rival.score >= kRivalShare * candidate.score)
        candidate.rivals.push_back(rival.T_scene_model);
    }
  }

 private:
  /// Other placements of the model that may look like this one, refined.
  std::vector<Pose> rivals_of(const Candidate& candidate,
                              std::span<const Candidate> candidates) const {
    const Pose& pose = candidate.T_scene_model;
    std::vector<Pose> rivals;
    const auto add = [&](const Pose& rival) {
      const auto differs = [&](const Pose& known) { return !same_placement(model_, known, rival); };
      if (allowed(rival) && differs(pose) && std::all_of(rivals.begin(), rivals.end(), differs))
        rivals.push_back(rival);
    };
    for (const Candidate& other : candidates) {
      if (other.model != candidate.model) continue;
      const float apart = (other.T_scene_model * model_.centre - pose * model_.centre).norm();
      if (apart < kRivalPlace * model_.diameter && other.score >= kLeastRivalScore)
        add(other.T_scene_model);
    }
    const kernels::RefineOptions sparse = sparse_refinement(), dense = dense_refinement();
    for (const Pose& motion : model_.near_symmetries)
      add(refined(refined(pose * motion, sparse), dense));
    return rivals;
  }

  kernels::RefineOptions sparse_refinement() const {
    kernels::RefineOptions sparse;
    sparse.num_samples = kRefineSamples;
    sparse.first_gate = std::max(1.5F * step_, 2 * strict_.tolerance);
    sparse.last_gate = strict_.tolerance;
    sparse.max_translation = 0.1F * model_.diameter;
    return sparse;
  }

  kernels::RefineOptions dense_refinement() const {
    kernels::RefineOptions dense;
    dense.num_samples = samples_.points.size();
    dense.max_iterations = 3;
    dense.first_gate = dense.last_gate = strict_.tolerance;
    dense.max_translation = 0.1F * model_.diameter;
    return dense;
  }

  /// Refine once more with all samples, and test by rays.
  Candidate examine(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                    const Pose& pose, kernels::ExamineScratch& scratch) const {
    kernels::ExamineOptions options;
    options.verify = strict_;
    options.window = std::round(scene_.window);
    options.waviness = scene_.waviness;
    Candidate candidate;
    candidate.T_scene_model = refined(pose, dense_refinement());
    candidate.tolerance = strict_.tolerance;
    kernels::examine_pose(scene_.images, surface, samples_, model_.symmetry,
                          candidate.T_scene_model, options, scratch, candidate.examination,
                          &candidate.explained);
    candidate.parts =
        kernels::score_parts(candidate.examination, strict_.tolerance / model_.diameter);
    const float seen = candidate.examination.consistent + candidate.examination.violation +
                       candidate.examination.background;
    const bool looked_through = candidate.examination.violation > kMostViolation * seen;
    // In scans without background nothing beside the object is measured, and small models would
    // find a place on anything. Of right poses on rendered scenes 99.4 % pass.
    const bool mostly_unknown = candidate.examination.unknown > candidate.examination.consistent;
    if (!looked_through && !mostly_unknown)
      candidate.score = kernels::pose_probability(score, candidate.parts);
    return candidate;
  }

  /// What stands for the test by rays where that is left out: the samples that meet the scene.
  Candidate judged_by_samples(const Look& look) const {
    Candidate candidate;
    candidate.T_scene_model = look.T_scene_model;
    candidate.tolerance = strict_.tolerance;
    candidate.score = look.score;
    std::vector<std::uint32_t>& pixels = candidate.explained.pixels;
    const kernels::Evidence e = kernels::verify_pose(
        scene_.images, samples_, samples_.points.size(), look.T_scene_model, strict_, &pixels);
    kernels::Examination& examination = candidate.examination;
    examination.covered = static_cast<float>(e.visible);
    examination.consistent = static_cast<float>(e.consistent);
    examination.violation = static_cast<float>(e.violation);
    examination.background = static_cast<float>(e.background);
    const float residual = e.rmse() / strict_.tolerance;
    const float side = model_.sample_spacing / model_.diameter;
    examination.residual = residual * residual;
    examination.area = examination.consistent * side * side;

    // A sample stands for the square of pixels between it and its neighbours.
    std::sort(pixels.begin(), pixels.end());
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    const kernels::ImageGeometry& camera = scene_.images.front().geometry;
    const float depth = (camera.T_camera_scene * (look.T_scene_model * model_.centre)).z();
    if (depth > 0) {
      const float square = std::round(model_.sample_spacing * camera.fx / depth);
      candidate.explained.square = static_cast<std::uint32_t>(std::clamp(square, 1.0F, 32.0F));
    }
    return candidate;
  }

  /// Score a look by what the first samples that the camera should see meet.
  void look_at(std::size_t num_samples, const kernels::VerifyOptions& options, Look& look) const {
    if (left_out(Improvement::visibility)) {
      look.score = look.votes;
      return;
    }
    look.evidence =
        kernels::verify_pose(scene_.images, samples_, num_samples, look.T_scene_model, options);
    look.score = look.evidence.score();
  }

  Pose refined(const Pose& pose, const kernels::RefineOptions& options) const {
    if (left_out(Improvement::refinement)) return pose;
    return kernels::refine_pose(scene_.images, samples_, pose, options).T_scene_model;
  }

  bool left_out(Improvement improvement) const { return options_.without.contains(improvement); }

  bool allowed(const Pose& pose) const {
    return options_.limits.allow(pose, model_.centre, 1 / scene_.scale);
  }

  void judge_contours(const kernels::VerifyOptions& options, std::span<Look> looks) const {
    if (left_out(Improvement::contour)) return;
    PerThread<kernels::ContourScratch> scratch;
    for_each_index(looks.size(), [&](std::size_t k) {
      kernels::judge_contour(scene_.images, samples_, kContourSamples, looks[k].T_scene_model,
                             options, scratch.local(), looks[k].evidence);
      looks[k].score = looks[k].evidence.score();
    });
  }

  const Model& model_;
  const PreparedScene& scene_;
  float step_;
  const RecogniseOptions& options_;
  SceneStats& stats_;
  kernels::ModelSamples samples_;
  std::vector<std::uint8_t> background_;
  kernels::VerifyOptions strict_;
};

}  // namespace

Result<std::vector<Candidate>> settle_model(const Recogniser& recogniser, std::uint32_t model_index,
                                            const PreparedScene& scene, float step,
                                            std::span<const kernels::Hypothesis> hypotheses,
                                            const RecogniseOptions& options, SceneStats& stats) {
  const Settling settling(recogniser.library().models[model_index], scene, step, options, stats);
  const std::vector<kernels::Hypothesis> clusters = settling.cluster(hypotheses);
  stats.num_hypotheses += clusters.size();
  const float num_votes = std::accumulate(
      hypotheses.begin(), hypotheses.end(), 0.0F,
      [](float sum, const kernels::Hypothesis& hypothesis) { return sum + hypothesis.votes; });
  std::vector<Look> looks = settling.preselect(clusters, num_votes);
  stats.num_refined += looks.size();
  looks = settling.refine(std::move(looks));
  stats.num_examined += looks.size();
  if (looks.empty()) return std::vector<Candidate>{};
  const Result<kernels::RayScene>& surface = recogniser.surface(model_index);
  if (!surface) return surface.error();
  std::vector<Candidate> candidates = settling.examine_all(*surface, recogniser.score(), looks);
  for (Candidate& candidate : candidates) candidate.model = model_index;
  return candidates;
}

Result<void> settle_rivals(const Recogniser& recogniser, const PreparedScene& scene, float step,
                           std::span<const Candidate> candidates, const RecogniseOptions& options,
                           SceneStats& stats, Candidate& candidate) {
  const Result<kernels::RayScene>& surface = recogniser.surface(candidate.model);
  if (!surface) return surface.error();
  const Settling settling(recogniser.library().models[candidate.model], scene, step, options,
                          stats);
  settling.settle_rivals(*surface, recogniser.score(), candidates, candidate);
  return {};
}

}  // namespace trivet::engine
