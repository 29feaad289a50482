#include "engine/verification/settle_model.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "engine/common/parallel.hpp"
#include "kernels/common/pose_math.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kCoarseSamples = 300;  // samples of the cheap verification before refinement
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
/// A pose after coarse verification: by samples of the surface.
struct CoarsePose {
  Source source = Source::ppf;
  Pose T_scene_model = Pose::Identity();
  float votes = 0;  // share of the source's votes for the model
  kernels::Evidence evidence;
  float score = 0;
};

/// Indices by falling value of a pose, ties by index.
std::vector<std::uint32_t> by(float CoarsePose::*value, std::span<const CoarsePose> poses) {
  std::vector<std::uint32_t> order(poses.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return poses[a].*value > poses[b].*value;
  });
  return order;
}

std::vector<std::uint32_t> by_score(std::span<const CoarsePose> poses) {
  return by(&CoarsePose::score, poses);
}

/// Poses chosen from the first on, so that no place takes more than its part of the budget.
class Spread {
 public:
  Spread(std::span<const CoarsePose> poses, const Model& model, std::uint32_t limit_a_place)
      : poses_(poses), model_(model), limit_a_place_(limit_a_place) {}

  /// Take those above a score in this order, until there are `limit` in all.
  void take(std::span<const std::uint32_t> order, float least_score, std::size_t limit) {
    for (const std::uint32_t c : order) {
      if (chosen_.size() == limit) return;
      if (!(poses_[c].score > least_score) || std::ranges::find(chosen_, c) != chosen_.end())
        continue;
      const Eigen::Vector3f center = poses_[c].T_scene_model * model_.center;
      const auto near = std::ranges::count_if(centers_, [&](const Eigen::Vector3f& other) {
        return (other - center).norm() < kPlace * model_.diameter;
      });
      if (near >= static_cast<std::ptrdiff_t>(limit_a_place_)) continue;
      chosen_.push_back(c);
      centers_.push_back(center);
    }
  }

  std::vector<CoarsePose> chosen() const {
    std::vector<CoarsePose> out;
    for (const std::uint32_t c : chosen_) out.push_back(poses_[c]);
    return out;
  }

 private:
  std::span<const CoarsePose> poses_;
  const Model& model_;
  std::uint32_t limit_a_place_;
  std::vector<std::uint32_t> chosen_;
  std::vector<Eigen::Vector3f> centers_;
};

/// Leave the best of poses that refinement led to one place; its source is the first of theirs.
std::vector<CoarsePose> without_repetitions(std::span<const CoarsePose> poses, const Model& model) {
  std::vector<CoarsePose> kept;
  for (const std::uint32_t c : by_score(poses)) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const CoarsePose& other) {
      const kernels::PoseDistance distance = kernels::pose_distance(
          other.T_scene_model, poses[c].T_scene_model, model.symmetry, model.center);
      return distance.translation < kSameTranslation * model.diameter &&
             distance.rotation_rad < kSameRotationRad;
    });
    if (known == kept.end()) {
      kept.push_back(poses[c]);
    } else {
      known->source = std::min(known->source, poses[c].source);
    }
  }
  return kept;
}

/// One model in one scene: what all its stages share.
class Settling {
 public:
  Settling(const PoseTester& tester, const SettleOptions& options, StageTimes& times)
      : tester_(tester),
        model_(tester.model()),
        scene_(tester.scene()),
        samples_(tester.samples()),
        options_(options),
        times_(times) {}

  /// The clusters of all proposals, not verified yet.
  std::vector<CoarsePose> cluster(std::span<const Proposals> proposals) const {
    const StageTimer timer(times_, "cluster");
    const kernels::ClusterOptions limits{options_.pose.cluster_translation * model_.diameter,
                                         options_.pose.cluster_rotation_deg * kRadiansPerDegree,
                                         options_.pose.max_clusters};
    std::vector<CoarsePose> poses;
    for (const Proposals& from : proposals) {
      float num_votes = 0, most = 0;
      for (const kernels::Hypothesis& hypothesis : from.hypotheses) num_votes += hypothesis.votes;
      for (const kernels::Hypothesis& cluster :
           kernels::cluster_poses(from.hypotheses, model_.symmetry, model_.center, limits)) {
        most = std::max(most, cluster.votes);  // the first one's
        if (cluster.votes < options_.pose.min_cluster_share * most) break;
        if (!tester_.allowed(cluster.T_scene_model)) continue;
        poses.push_back({from.source, cluster.T_scene_model, cluster.votes / num_votes, {}, 0});
      }
    }
    return poses;
  }

  /// Coarse verification with the tolerance of an unrefined pose chooses which ones to refine.
  std::vector<CoarsePose> preselect(std::vector<CoarsePose> poses) const {
    const StageTimer timer(times_, "preselect");
    for_each_index(poses.size(), [&](std::size_t c) {
      verify_coarsely(kCoarseSamples, tester_.loose(poses[c].T_scene_model), poses[c]);
    });
    // The contour only lowers a score, and costs more: it is judged for those that are in the
    // running.
    const std::size_t limit = options_.pose.max_refined;
    Spread first(poses, model_, kContourShare * kRefinedAPlace);
    first.take(by(&CoarsePose::votes, poses), 0, limit / 2);
    first.take(by_score(poses), 0, kContourShare * limit);
    std::vector<CoarsePose> running = first.chosen();
    judge_contours(running, [&](const Pose& pose) { return tester_.loose(pose); });
    // Half by what is seen, half by votes: what lies end-on or deep looks worse than it is.
    Spread best(running, model_, kRefinedAPlace);
    best.take(by_score(running), 0, limit - limit / 2);
    best.take(by(&CoarsePose::votes, running), 0, limit);
    return best.chosen();
  }

  std::vector<CoarsePose> refine(std::vector<CoarsePose> poses) const {
    {
      const StageTimer timer(times_, "refine");
      for_each_index(poses.size(), [&](std::size_t k) {
        poses[k].T_scene_model = tester_.refined(poses[k].T_scene_model);
      });
    }
    const StageTimer timer(times_, "verify");
    for_each_index(poses.size(), [&](std::size_t k) {
      verify_coarsely(samples_.points.size(), tester_.strict(poses[k].T_scene_model), poses[k]);
    });
    judge_contours(poses, [&](const Pose& pose) { return tester_.strict(pose); });
    poses = without_repetitions(poses, model_);
    Spread best(poses, model_, kExaminedAPlace);
    best.take(by_score(poses), options_.visibility ? kHopeless : 0, options_.pose.max_examined);
    return best.chosen();
  }

  /// Refine once more with all samples, and test by rays.
  std::vector<Candidate> examine_all(const kernels::RayScene& surface,
                                     const kernels::ScoreModel& score,
                                     std::span<const CoarsePose> poses) const {
    const StageTimer timer(times_, "examine");
    std::vector<Candidate> candidates(poses.size());
    PerThread<kernels::ExamineScratch> scratch;
    for_each_index(poses.size(), [&](std::size_t k) {
      candidates[k] =
          options_.rays ? tester_.examine(surface, score, tester_.polished(poses[k].T_scene_model),
                                          scratch.local())
                        : judged_by_samples(poses[k]);
      candidates[k].source = poses[k].source;
    });
    std::erase_if(candidates, [&](const Candidate& candidate) {
      return !tester_.allowed(candidate.T_scene_model);
    });
    return candidates;
  }

 private:
  /// What stands for the test by rays where that is left out: the samples that meet the scene.
  Candidate judged_by_samples(const CoarsePose& pose) const {
    Candidate candidate;
    candidate.T_scene_model = pose.T_scene_model;
    const kernels::VerifyOptions strict = tester_.strict(pose.T_scene_model);
    candidate.tolerance = strict.tolerance;
    candidate.score = pose.score;
    std::vector<std::uint32_t>& pixels = candidate.explained.pixels;
    const kernels::Evidence e = kernels::verify_pose(
        scene_.images, samples_, samples_.points.size(), pose.T_scene_model, strict, &pixels);
    kernels::Examination& examination = candidate.examination;
    examination.covered = static_cast<float>(e.visible);
    examination.consistent = static_cast<float>(e.consistent);
    examination.violation = static_cast<float>(e.violation);
    examination.background = static_cast<float>(e.background);
    const float residual = e.rmse() / strict.tolerance;
    const float side = model_.sample_spacing / model_.diameter;
    examination.mean_square = examination.residual = residual * residual;
    examination.area = examination.consistent * side * side;

    // A sample stands for the square of pixels between it and its neighbors.
    std::sort(pixels.begin(), pixels.end());
    pixels.erase(std::unique(pixels.begin(), pixels.end()), pixels.end());
    const kernels::ImageGeometry& camera = scene_.images.front().geometry;
    const float depth = (camera.T_camera_scene * (pose.T_scene_model * model_.center)).z();
    if (depth > 0) {
      const float square = std::round(model_.sample_spacing * camera.fx / depth);
      candidate.explained.square = static_cast<std::uint32_t>(std::clamp(square, 1.0F, 32.0F));
    }
    return candidate;
  }

  /// Score a pose by what the first samples that the camera should see meet.
  void verify_coarsely(std::size_t num_samples, const kernels::VerifyOptions& options,
                       CoarsePose& pose) const {
    if (!options_.visibility) {
      pose.score = pose.votes;
      return;
    }
    pose.evidence =
        kernels::verify_pose(scene_.images, samples_, num_samples, pose.T_scene_model, options);
    pose.score = pose.evidence.score();
  }

  /// options(pose)  as of PoseTester
  template <class Options>
  void judge_contours(std::span<CoarsePose> poses, Options&& options) const {
    if (!options_.contour) return;
    PerThread<kernels::ContourScratch> scratch;
    for_each_index(poses.size(), [&](std::size_t k) {
      kernels::judge_contour(scene_.images, samples_, kContourSamples, poses[k].T_scene_model,
                             options(poses[k].T_scene_model), scratch.local(), poses[k].evidence);
      poses[k].score = poses[k].evidence.score();
    });
  }

  const PoseTester& tester_;
  const Model& model_;
  const PreparedScene& scene_;
  const kernels::ModelSamples& samples_;
  const SettleOptions& options_;
  StageTimes& times_;
};

}  // namespace

Result<SettledModel> settle_model(const Recognizer& recognizer, std::uint32_t model_index,
                                  const PreparedScene& scene, float step,
                                  std::span<const Proposals> proposals,
                                  const SettleOptions& options, StageTimes& times) {
  const PoseTester tester(recognizer.library().models[model_index], scene, step, options.test);
  const Settling settling(tester, options, times);
  SettledModel settled;
  std::vector<CoarsePose> poses = settling.cluster(proposals);
  settled.num_hypotheses = poses.size();
  poses = settling.preselect(std::move(poses));
  settled.num_refined = poses.size();
  poses = settling.refine(std::move(poses));
  settled.num_examined = poses.size();
  if (poses.empty()) return settled;
  const Result<kernels::RayScene>& surface = recognizer.surface(model_index);
  if (!surface) return surface.error();
  settled.candidates = settling.examine_all(*surface, recognizer.score(), poses);
  for (Candidate& candidate : settled.candidates) candidate.model = model_index;
  return settled;
}

}  // namespace trivet::engine
