#include "engine/settle_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/parallel.hpp"
#include "engine/pose_tester.hpp"
#include "kernels/pose_math.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kFirstLookSamples =
    300;  // samples of the cheap verification before refinement
constexpr std::size_t kContourSamples = 700;
constexpr std::size_t kContourShare = 3;  // contours judged per candidate refined
constexpr float kPlace = 0.2F;            // in diameters
// Where many of a kind lie, the best seen ones must not take all of the budget.
constexpr std::uint32_t kRefinedAPlace = 4, kExaminedAPlace = 2;
// Score of a refined pose by samples below which no ray need be shot: of 600 examinations above 0.3
// on the development scans it lost none, of all examinations it saves two thirds.
constexpr float kHopeless = 0.05F;
constexpr float kSameTranslation = 0.01F;  // in diameters
constexpr float kSameRotationRad = 0.035F;
/// A pose that was looked at by samples of the surface.
struct Look {
  Source source = Source::ppf;
  Pose T_scene_model = Pose::Identity();
  float votes = 0;  // share of the source's votes for the model
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

/// Leave the best of poses that refinement led to one place; its source is the first of theirs.
std::vector<Look> without_repetitions(std::span<const Look> looks, const Model& model) {
  std::vector<Look> kept;
  for (const std::uint32_t c : by_score(looks)) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const Look& other) {
      const kernels::PoseDistance distance = kernels::pose_distance(
          other.T_scene_model, looks[c].T_scene_model, model.symmetry, model.centre);
      return distance.translation < kSameTranslation * model.diameter &&
             distance.rotation_rad < kSameRotationRad;
    });
    if (known == kept.end()) {
      kept.push_back(looks[c]);
    } else {
      known->source = std::min(known->source, looks[c].source);
    }
  }
  return kept;
}

/// One model in one scene: what all its stages look at.
class Settling {
 public:
  Settling(const PoseTester& tester, const RecogniseOptions& options, SceneStats& stats)
      : tester_(tester),
        model_(tester.model()),
        scene_(tester.scene()),
        samples_(tester.samples()),
        options_(options),
        stats_(stats) {}

  /// The clusters of all proposals, not looked at yet.
  std::vector<Look> cluster(std::span<const Proposals> proposals) const {
    const StageTimer timer(stats_.times, "cluster");
    const kernels::ClusterOptions limits{options_.pose.cluster_translation * model_.diameter,
                                         options_.pose.cluster_rotation_deg * kRadiansPerDegree,
                                         options_.pose.max_clusters};
    std::vector<Look> looks;
    for (const Proposals& from : proposals) {
      float num_votes = 0, most = 0;
      for (const kernels::Hypothesis& hypothesis : from.hypotheses) num_votes += hypothesis.votes;
      for (const kernels::Hypothesis& cluster :
           kernels::cluster_poses(from.hypotheses, model_.symmetry, model_.centre, limits)) {
        most = std::max(most, cluster.votes);  // the first one's
        if (cluster.votes < options_.pose.min_cluster_share * most) break;
        if (!tester_.allowed(cluster.T_scene_model)) continue;
        looks.push_back({from.source, cluster.T_scene_model, cluster.votes / num_votes, {}, 0});
      }
    }
    return looks;
  }

  /// A first look with the tolerance of an unrefined pose chooses which ones to refine.
  std::vector<Look> preselect(std::vector<Look> looks) const {
    const StageTimer timer(stats_.times, "preselect");
    for_each_index(looks.size(), [&](std::size_t c) {
      look_at(kFirstLookSamples, tester_.loose(looks[c].T_scene_model), looks[c]);
    });
    // The contour only lowers a score, and costs more: it is judged for those that are in the
    // running.
    std::vector<Look> running;
    for (const std::uint32_t c :
         best_spread(looks, model_, 0, kContourShare * options_.pose.max_refined,
                     kContourShare * kRefinedAPlace))
      running.push_back(looks[c]);
    judge_contours(running, [&](const Pose& pose) { return tester_.loose(pose); });
    std::vector<Look> best;
    for (const std::uint32_t c :
         best_spread(running, model_, 0, options_.pose.max_refined, kRefinedAPlace))
      best.push_back(running[c]);
    return best;
  }

  std::vector<Look> refine(std::vector<Look> looks) const {
    {
      const StageTimer timer(stats_.times, "refine");
      for_each_index(looks.size(), [&](std::size_t k) {
        looks[k].T_scene_model = tester_.refined(looks[k].T_scene_model);
      });
    }
    const StageTimer timer(stats_.times, "verify");
    for_each_index(looks.size(), [&](std::size_t k) {
      look_at(samples_.points.size(), tester_.strict(looks[k].T_scene_model), looks[k]);
    });
    judge_contours(looks, [&](const Pose& pose) { return tester_.strict(pose); });
    looks = without_repetitions(looks, model_);
    std::vector<Look> best;
    const float hopeless = tester_.left_out(Improvement::visibility) ? 0 : kHopeless;
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
      candidates[k] =
          tester_.left_out(Improvement::rays)
              ? judged_by_samples(looks[k])
              : tester_.examine(surface, score, tester_.polished(looks[k].T_scene_model),
                                scratch.local());
      candidates[k].source = looks[k].source;
    });
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return !tester_.allowed(candidate.T_scene_model);
    });
    return candidates;
  }

 private:
  /// What stands for the test by rays where that is left out: the samples that meet the scene.
  Candidate judged_by_samples(const Look& look) const {
    Candidate candidate;
    candidate.T_scene_model = look.T_scene_model;
    const kernels::VerifyOptions strict = tester_.strict(look.T_scene_model);
    candidate.tolerance = strict.tolerance;
    candidate.score = look.score;
    std::vector<std::uint32_t>& pixels = candidate.explained.pixels;
    const kernels::Evidence e = kernels::verify_pose(
        scene_.images, samples_, samples_.points.size(), look.T_scene_model, strict, &pixels);
    kernels::Examination& examination = candidate.examination;
    examination.covered = static_cast<float>(e.visible);
    examination.consistent = static_cast<float>(e.consistent);
    examination.violation = static_cast<float>(e.violation);
    examination.background = static_cast<float>(e.background);
    const float residual = e.rmse() / strict.tolerance;
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
    if (tester_.left_out(Improvement::visibility)) {
      look.score = look.votes;
      return;
    }
    look.evidence =
        kernels::verify_pose(scene_.images, samples_, num_samples, look.T_scene_model, options);
    look.score = look.evidence.score();
  }

  /// options(pose)  as of PoseTester
  template <class Options>
  void judge_contours(std::span<Look> looks, Options&& options) const {
    if (tester_.left_out(Improvement::contour)) return;
    PerThread<kernels::ContourScratch> scratch;
    for_each_index(looks.size(), [&](std::size_t k) {
      kernels::judge_contour(scene_.images, samples_, kContourSamples, looks[k].T_scene_model,
                             options(looks[k].T_scene_model), scratch.local(), looks[k].evidence);
      looks[k].score = looks[k].evidence.score();
    });
  }

  const PoseTester& tester_;
  const Model& model_;
  const PreparedScene& scene_;
  const kernels::ModelSamples& samples_;
  const RecogniseOptions& options_;
  SceneStats& stats_;
};

}  // namespace

Result<std::vector<Candidate>> settle_model(const Recogniser& recogniser, std::uint32_t model_index,
                                            const PreparedScene& scene, float step,
                                            std::span<const Proposals> proposals,
                                            const RecogniseOptions& options, SceneStats& stats) {
  const PoseTester tester(recogniser.library().models[model_index], scene, step, options);
  const Settling settling(tester, options, stats);
  std::vector<Look> looks = settling.cluster(proposals);
  stats.num_hypotheses += looks.size();
  looks = settling.preselect(std::move(looks));
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

}  // namespace trivet::engine
