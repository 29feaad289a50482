#include "engine/verification/pose_tester.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/common/checked_parts.hpp"
#include "kernels/common/pose_math.hpp"
#include "kernels/scans/estimate_normals_grid.hpp"
#include "kernels/verification/reach_behind.hpp"
#include "storage/common/clamped_integer.hpp"

namespace trivet::engine {
namespace {

constexpr std::size_t kRefineSamples = 500;
// The score is a sum, so that strong agreement could outweigh any violation. On rendered scenes,
// 99 % of the correct poses have less than 9 % of their visible surface seen through; 43 % of the
// wrong poses have more than 12 %.
constexpr float kMostViolation = 0.15F;
// Share of the diameter. Objects thinner than twice this width must not consist of edge alone.
constexpr float kMostEdge = 0.06F;
// Share of the noise. Correlated noise of real depth cameras is higher than this; windows leave a
// twentieth of independent noise.
constexpr float kCorrelated = 0.25F;
// Poses of a lower score are not moved to the optimum beside them. On development scans, results
// hardly depend on it up to 0.7.
constexpr float kWorthMoving = 0.1F;
// Of a likelier pose also the last short steps are taken.
constexpr float kLikely = 0.5F;
constexpr int kSteps = 8;
// Of 768 poses of lower scores in seven sets of real scans none became likelier than 0.3 by a
// narrower gate. Refused poses, whose scores are 0, may: they are looked through beside their place.
constexpr float kWorthNarrowing = 0.005F;
constexpr int kNarrowings = 8;  // each gate about half a standard deviation of the sensor narrower
// Edges know better than the score where a pose is, unless it is less likely there by this much
// [log odds]. Sensors that match windows shift edges.
constexpr double kAsGood = 1, kLeast = 1e-6;
// Of two poses that a test was made of, the second has to be that much likelier: the better of two
// noisy scores is too high [log odds].
constexpr double kClearlyBetter = 1;
// Unless its residuals are half as large (fits_closer).
constexpr float kMuchCloser = 0.25F;
// What all measurements of an object may be off together, which no number of them reduces [their
// standard deviation]. Of 583 poses in made scans by laser and structured light, half of which it was
// not chosen on, 92 % lie in the region that should hold 90 %, alike by both sensors.
constexpr float kSharedError = 0.15F;
// Parts deviate from models smoothly, over as much as their size. A pose follows a share of that, and
// another is left across surfaces. Of 172 made parts that deviate by 0.5 % of their diameters 9 of 10
// lie in the region that should hold 90 %.
constexpr float kFollowedDeviation = 0.6F, kLeftDeviation = 0.6F;
// Without a stated deviation, residuals show what a pose has not followed, and it follows so much
// more. Of 250 parts that deviate by 0.5 % of their diameters 86, 90 and 79 % by laser, stereo and
// structured light lie in the region that should hold 90 % (1, 7 and 29 % without); by 2.5 they are
// 94, 90 and 80 %, by 2 they are 86, 87 and 78 %.
constexpr float kFollowedLeft = 2.25F;
// What a filter moves a surface by may be wrong by as much: its length is estimated, its form assumed.
constexpr float kFilterError = 1;
// Poses that differ by less are the same for edges; robust weights shorten steps, and a pose stands
// still where they are shorter than the second [pixel].
constexpr float kApart = 0.5F, kStill = 0.1F;
// Refined poses farther from the proposed one, in diameters, are other poses.
constexpr float kMostShift = 0.1F, kMostTurnRad = 0.35F;
// Errors of a pose are smaller in 99.9 % of all cases [standard deviations].
constexpr float kPoseSigmas = 3;
// Samples for what the scan shows behind a plane, and how many of them are no stray measurements.
constexpr std::size_t kSamplesBehind = 300, kFewestBehind = 8;
// Samples are compared without the smoothing of the sensor, and differ by more.
constexpr float kSmoothedTolerance = 1.5F;
// A measurement errs by this share of the tolerance at least.
constexpr float kLeastError = 0.05F;

}  // namespace

bool fits_closer(const PoseFit& pose, const PoseFit& other) noexcept {
  return pose.mean_square < kMuchCloser * other.mean_square &&
         kernels::log_odds(pose.score, kLeast) >
             kernels::log_odds(other.score, kLeast) - kClearlyBetter;
}

Result<TestedModel> tested_model(const Library& library, std::uint32_t model) {
  TRIVET_TRY_ASSIGN(const kernels::ModelSamples samples, kernel_samples(library, model));
  return TestedModel{library.models[model], samples,
                     library.shape(model).quantization.distance_step};
}

PoseTester::PoseTester(const TestedModel& model, const PreparedScene& scene,
                       const PoseTestOptions& options)
    : model_(model.info),
      scene_(scene),
      options_(options),
      samples_(model.samples),
      distance_step_(model.distance_step),
      deviation_(options.verify.model_deviation * static_cast<float>(scene.scale)) {
  if (options.background) background_ = background_planes(scene, model_.diameter);
  for (std::size_t k = 0; k < background_.size(); ++k)
    faces_[k + 1] = background_[k] != 0 && scene.ground[k] == 0;
}

float PoseTester::range_of(const Pose& pose) const {
  return (scene_.images.front().geometry.T_camera_scene * (pose * model_.center)).z();
}

float PoseTester::error_at(const Pose& pose) const {
  return std::hypot(scene_.sensor.error_at(range_of(pose)), kLeftDeviation * deviation_);
}

float PoseTester::pixel_at(const Pose& pose) const {
  return range_of(pose) / scene_.images.front().geometry.fx;
}

float PoseTester::tolerance_at(const Pose& pose) const {
  return std::max(options_.verify.tolerance_sigmas * error_at(pose),
                  options_.verify.tolerance_diameters * model_.diameter);
}

kernels::VerifyOptions PoseTester::strict(const Pose& pose) const {
  kernels::VerifyOptions strict;
  strict.tolerance = tolerance_at(pose);
  strict.plane_is_background = background_;
  strict.bearing_plane = bearing_plane(pose, strict.tolerance);
  strict.open_planes = open_planes(pose, strict.tolerance);
  return strict;
}

/// The background planes behind which the scan shows something where the model is: they end there, as
/// the face of a plate does that lies on another part, and hide only what is beneath them.
kernels::PlaneSet PoseTester::open_planes(const Pose& pose, float tolerance) const {
  kernels::PlaneSet open;
  for (std::size_t k = 0; k < background_.size(); ++k) {
    if (!faces_[k + 1]) continue;
    const kernels::Plane& plane = scene_.planes[k];
    open[k + 1] = kernels::count_seen_behind(scene_.images.front(), samples_, kSamplesBehind, pose,
                                             plane, tolerance + plane.thickness) >= kFewestBehind;
  }
  return open;
}

/// The number of the background plane on which a model at this pose bears while a part of it is
/// behind; 0: none. A screw's head rests on what its shank is let into. The same force acts on head
/// and shank, and what the screw is let into is no stronger than the screw: so the area on which it
/// bears is at least that of the hole.
std::uint8_t PoseTester::bearing_plane(const Pose& pose, float tolerance) const {
  for (std::size_t k = 0; k < background_.size(); ++k) {
    if (background_[k] == 0) continue;
    const kernels::Plane& plane = scene_.planes[k];
    const kernels::PlaneReach reach =
        kernels::reach_behind(samples_, pose, plane, tolerance + plane.thickness);
    if (reach.entering > 0 && reach.bearing >= reach.entering)
      return static_cast<std::uint8_t>(k + 1);
  }
  return 0;
}

/// How deep a tested pose is in a plane of the ground, of which the scan shows all sides; 0: not
/// deeper than its errors and those of the plane explain, or in a hole, as a screw that bears on
/// the plane is. Where something lies on the model, or is part of what is there, it may be another
/// part that is turned over: its mirror image, whose raised parts the hidden ones take for holes.
float PoseTester::depth_in_ground(const Pose& pose, const FullTest& test,
                                  std::uint8_t bearing) const {
  const bool is_clear = !(test.examination.overlaid > 0);
  const kernels::RangeImage& image = scene_.images.front();
  for (std::size_t k = 0; k < background_.size(); ++k) {
    if (background_[k] == 0 || scene_.ground[k] == 0) continue;
    if (is_clear && k + 1 == bearing) continue;
    const kernels::Plane& plane = scene_.planes[k];
    const float tolerance = test.largest_tolerance + plane.thickness;
    const kernels::PlaneReach reach = kernels::reach_behind(samples_, pose, plane, tolerance);
    const Eigen::Vector3f normal = pose.linear().transpose() * plane.normal;
    Eigen::Matrix<float, 6, 1> J;  // of the deepest place's height for motions of the pose
    J.head<3>() = normal;
    J.tail<3>() = (reach.deepest - model_.center).cross(normal);
    const float sigma = std::sqrt(std::max(0.0F, J.dot(test.covariance * J)));
    if (!(reach.depth > tolerance + kPoseSigmas * sigma)) continue;
    const Eigen::Vector3f above = pose * reach.deepest + reach.depth * plane.normal;
    if (kernels::is_surrounded(image, static_cast<std::uint8_t>(k + 1),
                               image.geometry.T_camera_scene * above))
      return reach.depth;
  }
  return 0;
}

kernels::MeasurementErrors PoseTester::errors_of(const Pose& pose) const {
  // In correlated noise, half a patch of the measurement windows errs alike.
  const int window = 2 * clamped_integer(std::round(scene_.window), 0,
                                         static_cast<int>(kernels::GridNormalOptions::kMaxWindow)) +
                     1;
  const bool correlated =
      deviation_ > 0 || scene_.sensor.correlated_noise.height > kCorrelated * scene_.sensor.noise;
  return {error_at(pose), correlated ? static_cast<int>(kernels::kPatch / 2) * window : 3,
          scene_.sensor.correlation};
}

int PoseTester::edge_pixels(const Pose& pose) const {
  const float pixels = model_.diameter * scene_.images.front().geometry.fx / range_of(pose);
  return static_cast<int>(
      std::lround(std::clamp(kMostEdge * pixels, 0.0F, scene_.sensor.edge_pixels())));
}

kernels::VerifyOptions PoseTester::loose(const Pose& pose) const {
  kernels::VerifyOptions loose;
  loose.tolerance = std::max(0.75F * distance_step_, 3 * error_at(pose));
  if (scene_.sensor.smoothing > 0) loose.tolerance *= kSmoothedTolerance;
  loose.plane_is_background = background_;
  loose.open_planes = faces_;
  return loose;
}

Pose PoseTester::refined(const Pose& pose) const {
  const float tolerance = tolerance_at(pose);
  kernels::RefineOptions sparse;
  sparse.num_samples = kRefineSamples;
  sparse.first_gate = std::max(1.5F * distance_step_, 2 * tolerance);
  sparse.last_gate = tolerance;
  sparse.max_translation = kMostShift * model_.diameter;
  return refined(pose, sparse);
}

Pose PoseTester::refined_nearby(const Pose& pose) const {
  kernels::RefineOptions nearby = narrowing(pose);
  nearby.num_samples = kRefineSamples;
  return refined(pose, nearby);
}

Pose PoseTester::polished(const Pose& pose) const {
  kernels::RefineOptions dense;
  dense.num_samples = samples_.points.size();
  dense.max_iterations = 3;
  dense.first_gate = dense.last_gate = tolerance_at(pose);
  dense.max_translation = kMostShift * model_.diameter;
  return refined(pose, dense);
}

/// Refine a pose with less and less of what is farther from it than the sensor errs: of surfaces that
/// lie closer to each other than the model's tolerance, one remains.
Pose PoseTester::sharpened(const Pose& pose) const {
  kernels::RefineOptions dense = narrowing(pose);
  dense.num_samples = samples_.points.size();
  dense.max_iterations = kNarrowings;
  return refined(pose, dense);
}

/// A gate from the tolerance down to the sensor's error.
kernels::RefineOptions PoseTester::narrowing(const Pose& pose) const {
  kernels::RefineOptions options;
  options.first_gate = tolerance_at(pose);
  options.last_gate =
      std::min(options.first_gate, options_.verify.tolerance_sigmas * error_at(pose));
  options.max_translation = kMostShift * model_.diameter;
  return options;
}

Pose PoseTester::refined(const Pose& pose, const kernels::RefineOptions& options) const {
  if (!options_.refinement) return pose;
  kernels::RefineOptions to = options;
  to.plane_is_background = background_;
  return kernels::refine_pose(scene_.images, samples_, pose, to).T_scene_model;
}

kernels::ExamineOptions PoseTester::examine_options(const Pose& pose) const {
  kernels::ExamineOptions options;
  options.verify = strict(pose);
  options.window = std::round(scene_.window);
  options.correlated_noise = scene_.sensor.correlated_noise_at(range_of(pose));
  options.correlated_noise.height =
      std::hypot(options.correlated_noise.height, kLeftDeviation * deviation_);
  options.correlation = scene_.sensor.correlation;
  options.edge_pixels = edge_pixels(pose);
  options.smoothing = scene_.sensor.smoothing;
  options.least_tolerance = std::max(options_.verify.tolerance_sigmas * error_at(pose),
                                     kLeastError * options.verify.tolerance);
  options.error = std::max(error_at(pose), kLeastError * options.verify.tolerance);
  return options;
}

/// How an object is turned about its axis is a separate question from whether it is present.
const std::optional<Symmetry::Axis>& PoseTester::free_axis() const {
  return model_.symmetry.axis ? model_.symmetry.axis : model_.near_axis;
}

std::vector<kernels::JudgedRay> PoseTester::judged_rays(const kernels::RayScene& surface,
                                                        const Pose& pose) const {
  kernels::ExamineScratch scratch;
  std::vector<kernels::JudgedRay> rays;
  kernels::examine_pose(scene_.images, {surface, samples_, pose}, free_axis(),
                        examine_options(pose), scratch, {.rays = &rays});
  return rays;
}

TestedPose PoseTester::polish_and_examine(const kernels::RayScene& surface,
                                          const kernels::ScoreModel& score, const Pose& pose,
                                          kernels::ExamineScratch& scratch) const {
  const Pose wide = polished(pose);
  TestedPose tested = examine(surface, score, wide, scratch);
  if (tested.score > 0 && tested.score < kWorthNarrowing) return tested;
  const Pose narrow = sharpened(wide);
  if (!are_apart(wide, narrow, kApart)) return tested;
  TestedPose other = examine(surface, score, narrow, scratch);
  const bool is_better = fits_closer({other.score, other.test.examination.mean_square},
                                     {tested.score, tested.test.examination.mean_square}) ||
                         kernels::log_odds(other.score, kLeast) >
                             kernels::log_odds(tested.score, kLeast) + kClearlyBetter;
  return is_better ? std::move(other) : std::move(tested);
}

TestedPose PoseTester::examine(const kernels::RayScene& surface, const kernels::ScoreModel& score,
                               const Pose& pose, kernels::ExamineScratch& scratch) const {
  kernels::PoseEquations equations;
  TestedPose tested = examine_once(surface, score, pose, scratch, equations), optimum;
  Pose at = pose;
  float score_at = tested.score;
  for (int step = 0; step < kSteps && score_at > kWorthMoving; ++step) {
    const std::optional<Pose> moved = solve(at, equations);
    if (!moved || !are_apart(at, *moved, score_at > kLikely ? kStill : kApart)) break;
    at = *moved;
    optimum = examine_once(surface, score, at, scratch, equations);
    score_at = optimum.score;
  }
  const bool is_better = kernels::log_odds(score_at, kLeast) >
                             kernels::log_odds(tested.score, kLeast) -
                                 kAsGood * static_cast<double>(1 - scene_.sensor.correlation) &&
                         are_apart(pose, at, kApart);
  TestedPose& best = is_better ? optimum : tested;
  // Not before the pose is where it fits best: beside it the sensor sees through what stands out.
  if (best.test.examination.seen_through > 0) best.score = 0;
  return std::move(best);
}

/// Whether two poses differ by more than so many pixels, and what the scan shifts edges by.
bool PoseTester::are_apart(const Pose& a, const Pose& b, float pixels) const {
  const float shift = (a * model_.center - b * model_.center).norm();
  const float turn = kernels::rotation_angle(a.linear(), b.linear());
  return shift + 0.5F * model_.diameter * turn >
         pixels * static_cast<float>(1 + edge_pixels(a)) * pixel_at(a);
}

/// The pose that solves the equations; empty if it is far away.
std::optional<Pose> PoseTester::solve(const Pose& pose,
                                      const kernels::PoseEquations& equations) const {
  Eigen::Matrix<double, 6, 6> A = equations.information;
  A.diagonal().array() += 1e-9 * A.diagonal().maxCoeff() + 1e-30;
  const Eigen::Matrix<double, 6, 1> x = A.ldlt().solve(equations.gradient);
  if (!x.allFinite()) return std::nullopt;
  const double radius = 0.5 * static_cast<double>(model_.diameter);
  const Eigen::Vector3f turn = (x.head<3>() / radius).cast<float>(),
                        shift = x.tail<3>().cast<float>();
  if (!(shift.norm() < kMostShift * model_.diameter) || !(turn.norm() < kMostTurnRad))
    return std::nullopt;
  Pose moved = kernels::small_motion(turn, shift, pose * model_.center) * pose;
  moved.linear() = Eigen::Quaternionf(moved.linear()).normalized().toRotationMatrix();
  return moved;
}

TestedPose PoseTester::examine_once(const kernels::RayScene& surface,
                                    const kernels::ScoreModel& score, const Pose& pose,
                                    kernels::ExamineScratch& scratch,
                                    kernels::PoseEquations& equations) const {
  const kernels::ExamineOptions options = examine_options(pose);
  TestedPose tested;
  FullTest& test = tested.test;
  tested.T_scene_model = pose;
  test.largest_tolerance = options.verify.tolerance;
  const kernels::Examination& e = test.examination =
      kernels::examine_pose(scene_.images, {surface, samples_, pose}, free_axis(), options, scratch,
                            {.explained = &test.explained, .equations = &equations});
  test.covariance = kernels::pose_covariance(
      equations, pose, model_.center, 0.5F * model_.diameter,
      std::hypot(std::hypot(kSharedError * options.error, kFollowedDeviation * deviation_,
                            kFilterError * e.smoothing_shift),
                 kFollowedLeft * e.deviation),
      model_.symmetry.axis);
  test.parts = kernels::score_parts(e, e.tolerance / model_.diameter, scene_.sensor.correlation);
  const bool looked_through =
      e.violation > kMostViolation * (e.consistent + e.violation + e.background);
  test.depth_in_ground = depth_in_ground(pose, test, options.verify.bearing_plane);
  if (!looked_through && !(test.depth_in_ground > 0))
    tested.score = kernels::pose_probability(score, test.parts);
  return tested;
}

}  // namespace trivet::engine
