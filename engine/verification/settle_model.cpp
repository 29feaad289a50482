#include "engine/verification/settle_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/common/parallel.hpp"
#include "engine/verification/pose_tester.hpp"
#include "kernels/common/pose_math.hpp"

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

/// Indices by falling value of a look, ties by index.
std::vector<std::uint32_t> by(float Look::*value, std::span<const Look> looks) {
  std::vector<std::uint32_t> order(looks.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return looks[a].*value > looks[b].*value;
  });
  return order;
}

std::vector<std::uint32_t> by_score(std::span<const Look> looks) { return by(&Look::score, looks); }

/// Looks chosen from the first on, so that no place takes more than its part of the budget.
class Spread {
 public:
  Spread(std::span<const Look> looks, const Model& model, std::uint32_t limit_a_place)
      : looks_(looks), model_(model), limit_a_place_(limit_a_place) {}

  /// Take those above a score in this order, until there are `limit` in all.
  void take(std::span<const std::uint32_t> order, float least_score, std::size_t limit) {
    for (const std::uint32_t c : order) {
      if (chosen_.size() == limit) return;
      if (!(looks_[c].score > least_score) || std::ranges::find(chosen_, c) != chosen_.end())
        continue;
      const Eigen::Vector3f center = looks_[c].T_scene_model * model_.center;
      const auto near = std::ranges::count_if(centers_, [&](const Eigen::Vector3f& other) {
        return (other - center).norm() < kPlace * model_.diameter;
      });
      if (near >= static_cast<std::ptrdiff_t>(limit_a_place_)) continue;
      chosen_.push_back(c);
      centers_.push_back(center);
    }
  }

  std::vector<Look> chosen() const {
    std::vector<Look> out;
    for (const std::uint32_t c : chosen_) out.push_back(looks_[c]);
    return out;
  }

 private:
  std::span<const Look> looks_;
  const Model& model_;
  std::uint32_t limit_a_place_;
  std::vector<std::uint32_t> chosen_;
  std::vector<Eigen::Vector3f> centers_;
};

/// Leave the best of poses that refinement led to one place; its source is the first of theirs.
std::vector<Look> without_repetitions(std::span<const Look> looks, const Model& model) {
  std::vector<Look> kept;
  for (const std::uint32_t c : by_score(looks)) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const Look& other) {
      const kernels::PoseDistance distance = kernels::pose_distance(
          other.T_scene_model, looks[c].T_scene_model, model.symmetry, model.center);
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
  Settling(const PoseTester& tester, const RecognizeOptions& options, SceneStats& stats)
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
           kernels::cluster_poses(from.hypotheses, model_.symmetry, model_.center, limits)) {
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
    const std::size_t limit = options_.pose.max_refined;
    Spread first(looks, model_, kContourShare * kRefinedAPlace);
    first.take(by(&Look::votes, looks), 0, limit / 2);
    first.take(by_score(looks), 0, kContourShare * limit);
    std::vector<Look> running = first.chosen();
    judge_contours(running, [&](const Pose& pose) { return tester_.loose(pose); });
    // Half by what is seen, half by votes: what lies end-on or deep looks worse than it is.
    Spread best(running, model_, kRefinedAPlace);
    best.take(by_score(running), 0, limit - limit / 2);
    best.take(by(&Look::votes, running), 0, limit);
    return best.chosen();
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
    Spread best(looks, model_, kExaminedAPlace);
    best.take(by_score(looks), tester_.left_out(Improvement::visibility) ? 0 : kHopeless,
              options_.pose.max_examined);
    return best.chosen();
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

    // A sample stands for the square of pixels between it and its neighbors.
    std::sort(pixels.begin(), pixels.end());
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    const kernels::ImageGeometry& camera = scene_.images.front().geometry;
    const float depth = (camera.T_camera_scene * (look.T_scene_model * model_.center)).z();
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
  const RecognizeOptions& options_;
  SceneStats& stats_;
};

}  // namespace

Result<std::vector<Candidate>> settle_model(const Recognizer& recognizer, std::uint32_t model_index,
                                            const PreparedScene& scene, float step,
                                            std::span<const Proposals> proposals,
                                            const RecognizeOptions& options, SceneStats& stats) {
  const PoseTester tester(recognizer.library().models[model_index], scene, step, options);
  const Settling settling(tester, options, stats);
  std::vector<Look> looks = settling.cluster(proposals);
  stats.num_hypotheses += looks.size();
  looks = settling.preselect(std::move(looks));
  stats.num_refined += looks.size();
  looks = settling.refine(std::move(looks));
  stats.num_examined += looks.size();
  if (looks.empty()) return std::vector<Candidate>{};
  const Result<kernels::RayScene>& surface = recognizer.surface(model_index);
  if (!surface) return surface.error();
  std::vector<Candidate> candidates = settling.examine_all(*surface, recognizer.score(), looks);
  for (Candidate& candidate : candidates) candidate.model = model_index;
  return candidates;
}

}  // namespace trivet::engine
