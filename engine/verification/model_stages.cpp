#include "engine/verification/model_stages.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kernels/common/pose_math.hpp"

namespace trivet::engine {
namespace {

constexpr float kRadiansPerDegree = 3.14159265358979F / 180;
constexpr std::size_t kCoarseSamples = 300;  // samples of the cheap verification before refinement
constexpr std::size_t kContourSamples = 700;
constexpr std::size_t kMarkSamples = 100;  // that tell whether a pose lies where another does
constexpr float kPlace = 0.2F;             // in diameters
// Where many of a kind lie, the best seen ones must not take all of the budget.
constexpr std::uint32_t kRefinedAPlace = 4, kExaminedAPlace = 2;
// Score of a refined pose by samples below which no ray need be shot: of 600 examinations above 0.3
// on the development scans it lost none, of all examinations it saves two thirds.
constexpr float kHopeless = 0.05F;
constexpr float kSameTranslation = 0.01F;  // in diameters
constexpr float kSameRotationRad = 0.035F;
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

}  // namespace

ModelStages::ModelStages(const Recognizer& recognizer, std::uint32_t model,
                         const PreparedScene& scene, const SettleOptions& options)
    : index_(model),
      model_(recognizer.library().models[model]),
      tester_(model_, scene, model_.ppf.quantization.distance_step, options.test),
      scene_(scene),
      options_(options) {}

std::vector<CoarsePose> ModelStages::cluster(std::span<const Proposals> proposals) const {
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
      poses.push_back(
          {from.source, cluster.T_scene_model, cluster.votes, cluster.votes / num_votes});
    }
  }
  return poses;
}

void ModelStages::look(CoarsePose& pose) const {
  verify_coarsely(kCoarseSamples, tester_.loose(pose.T_scene_model), pose);
}

std::vector<CoarsePose> ModelStages::in_the_running(std::span<const CoarsePose> looked_at) const {
  const std::size_t limit = options_.pose.max_refined;
  Spread first(looked_at, model_, kContourShare * kRefinedAPlace);
  first.take(by(&CoarsePose::share, looked_at), 0, limit / 2);
  first.take(by_score(looked_at), 0, kContourShare * limit);
  return first.chosen();
}

void ModelStages::judge_contour(CoarsePose& pose, kernels::ContourScratch& scratch) const {
  judge_contour(tester_.loose(pose.T_scene_model), scratch, pose);
}

std::vector<CoarsePose> ModelStages::preselect(std::span<const CoarsePose> judged) const {
  const std::size_t limit = options_.pose.max_refined;
  Spread best(judged, model_, kRefinedAPlace);
  best.take(by_score(judged), 0, limit - limit / 2);
  best.take(by(&CoarsePose::share, judged), 0, limit);
  return best.chosen();
}

void ModelStages::refine(CoarsePose& pose) const {
  pose.T_scene_model = tester_.refined(pose.T_scene_model);
}

void ModelStages::verify(CoarsePose& pose, kernels::ContourScratch& scratch) const {
  const kernels::VerifyOptions strict = tester_.strict(pose.T_scene_model);
  verify_coarsely(tester_.samples().points.size(), strict, pose);
  judge_contour(strict, scratch, pose);
}

std::vector<CoarsePose> ModelStages::hopeful(std::span<const CoarsePose> verified) const {
  const std::vector<CoarsePose> poses = without_repetitions(verified, model_);
  Spread best(poses, model_, kExaminedAPlace);
  best.take(by_score(poses), options_.visibility ? kHopeless : 0, options_.pose.max_examined);
  return best.chosen();
}

std::optional<Candidate> ModelStages::examine(const kernels::RayScene& surface,
                                              const kernels::ScoreModel& score,
                                              const CoarsePose& pose,
                                              kernels::ExamineScratch& scratch) const {
  Candidate candidate =
      options_.rays ? tester_.examine(surface, score, tester_.polished(pose.T_scene_model), scratch)
                    : judged_by_samples(pose);
  if (!tester_.allowed(candidate.T_scene_model)) return std::nullopt;
  candidate.source = pose.source;
  candidate.model = index_;
  return candidate;
}

bool ModelStages::is_marked(const CoarsePose& pose, std::span<const std::uint8_t> marked) const {
  std::vector<std::uint32_t> pixels;
  (void)kernels::verify_pose(scene_.images, tester_.samples(), kMarkSamples, pose.T_scene_model,
                             tester_.loose(pose.T_scene_model), &pixels);
  const auto count =
      std::ranges::count_if(pixels, [&](std::uint32_t pixel) { return marked[pixel] != 0; });
  return 2 * static_cast<std::size_t>(count) > pixels.size();
}

/// What stands for the test by rays where that is left out: the samples that meet the scene.
Candidate ModelStages::judged_by_samples(const CoarsePose& pose) const {
  Candidate candidate;
  candidate.T_scene_model = pose.T_scene_model;
  const kernels::VerifyOptions strict = tester_.strict(pose.T_scene_model);
  candidate.tolerance = strict.tolerance;
  candidate.score = pose.score;
  std::vector<std::uint32_t>& pixels = candidate.explained.pixels;
  const kernels::Evidence e =
      kernels::verify_pose(scene_.images, tester_.samples(), tester_.samples().points.size(),
                           pose.T_scene_model, strict, &pixels);
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
void ModelStages::verify_coarsely(std::size_t num_samples, const kernels::VerifyOptions& options,
                                  CoarsePose& pose) const {
  if (!options_.visibility) {
    pose.score = pose.share;
    return;
  }
  pose.evidence = kernels::verify_pose(scene_.images, tester_.samples(), num_samples,
                                       pose.T_scene_model, options);
  pose.score = pose.evidence.score();
}

void ModelStages::judge_contour(const kernels::VerifyOptions& options,
                                kernels::ContourScratch& scratch, CoarsePose& pose) const {
  if (!options_.contour) return;
  kernels::judge_contour(scene_.images, tester_.samples(), kContourSamples, pose.T_scene_model,
                         options, scratch, pose.evidence);
  pose.score = pose.evidence.score();
}

}  // namespace trivet::engine
