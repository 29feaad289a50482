/// Options of recognition. options_of<RecognizeOptions>() defines their ranges, defaults and
/// meanings for users.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/options/improvements.hpp"
#include "engine/options/method.hpp"
#include "engine/options/option.hpp"
#include "engine/options/pose_limits.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"
#include "storage/common/result.hpp"

namespace trivet {

/// Options of voting by point pair features.
struct VoteOptions {
  /// Radius of the ball around a reference point that contains the partners of its pairs
  /// [diameters]. A smaller ball is faster and tolerates more occlusion; a larger one tolerates
  /// more noise.
  float radius = 0.4F;
  float reference_share = 0.1F;  ///< share of the sampled scene points that become references
  std::uint32_t max_references = 2000;  ///< maximum number of references per size of models
  float neighbor_share = 0;  ///< share of a bin, at its ends, where the adjacent cell votes too
  /// Maximum per reference point and model; the fullest cells are dropped first.
  std::uint32_t max_votes = 40000;
  std::uint32_t max_peaks = 2;  ///< maximum number of poses per reference point
  float peak_share = 0.9F;      ///< share of a reference point's best peak; lower peaks are dropped
  bool operator==(const VoteOptions&) const = default;
};

/// Keypoint detectors of a scene.
enum class Detector : std::uint8_t {
  uniform,  ///< evenly spaced points
  iss,      ///< intrinsic shape signatures
  harris,   ///< Harris 3D
};

/// Methods of grouping a model's correspondences into poses.
enum class Grouping : std::uint8_t {
  frames,       ///< each correspondence gives one pose, by its two local reference frames
  consistency,  ///< correspondences whose distances agree give one pose together
  ransac,       ///< correspondences that are inliers of a pose from three of them give one pose
};

/// Options of matching Tri-Spin-Images. By default, features match by nearest neighbors; a
/// threshold on their distance or on their ratio to the second nearest are the other strategies of
/// the thesis.
struct MatchOptions {
  Detector detector = Detector::uniform;
  float spacing = 3;  ///< spacing of a scene's keypoints [resolutions of the models]
  /// Maximum number of described keypoints, evenly among the pixels; a fifth of it after votes.
  std::uint32_t max_keypoints = 10000;
  /// Limits for keypoints; flat, border and unstable ones are dropped.
  kernels::FrameLimits limits{};
  /// Number of model features that each scene feature is matched with.
  std::uint32_t num_neighbors = 3;
  std::uint32_t num_lists = 4;  ///< number of inverted lists to search; more is more exact
  /// Maximum distance of matched features.
  float max_distance = std::numeric_limits<float>::infinity();
  /// Maximum ratio of this distance to that of the nearest feature of another model, or of a place
  /// farther away than half a support; 1: no limit.
  float max_ratio = 1;
  bool weigh_by_ratio = false;  ///< whether a match has 1 - ratio votes instead of 1
  Grouping grouping = Grouping::frames;
  bool operator==(const MatchOptions&) const = default;
};

/// Options of the path from hypotheses to poses: how many of them are pursued.
struct PoseOptions {
  /// Maximum translation between poses of a cluster [diameters].
  float cluster_translation = 0.07F;
  float cluster_rotation_deg = 15;  ///< maximum rotation between poses of a cluster [deg]
  /// Clusters per model that are kept for the first verification.
  std::uint32_t max_clusters = 300;
  /// Minimum share of the best cluster's votes; clusters with fewer are dropped. The thesis uses
  /// 0.5.
  float min_cluster_share = 0;
  std::uint32_t max_refined = 60;  ///< maximum number of refined candidates per model
  /// Maximum number of refined candidates per model that rays test.
  std::uint32_t max_examined = 40;
  /// Number of search rounds. Later rounds search what is not yet explained; 0: only test expected
  /// poses.
  std::uint32_t rounds = 2;
  bool operator==(const PoseOptions&) const = default;
};

/// Options of deciding whether a pose agrees with the scan.
struct VerifyStageOptions {
  float tolerance_sigmas = 3;          ///< tolerance in standard deviations of the scene's noise
  float tolerance_diameters = 0.016F;  ///< minimum tolerance as a share of the diameter
  /// What the parts are off their models, root mean square [scene file's unit].
  float model_deviation = 0;
  float max_overlap = 0.4F;  ///< maximum share of a detection's pixels that better ones explain
  bool operator==(const VerifyStageOptions&) const = default;
};

/// Value of doubtful_score for curves over the score and for files that contain every pose.
inline constexpr float kLowestKeptScore = 0.1F;

/// Strategies for searching the models of a library.
enum class Search : std::uint8_t {
  automatic,   ///< within a budget for large libraries, exhaustive for small ones
  exhaustive,  ///< each model separately
};

/// A place of the scene for which recognition explains why models are found there or not.
struct PlaceQuestion {
  std::optional<Eigen::Vector3d> point{};  ///< place in the frame and unit of the scene's file
  std::vector<std::string> models{};  ///< models to explain; empty: all with poses near the place
  bool operator==(const PlaceQuestion&) const = default;
};

/// All options of recognition. The defaults are the balanced preset.
struct RecognizeOptions {
  Method method = Method::fused;
  Search search = Search::automatic;
  float budget = 1;  ///< budget for searching large libraries: factor on all limits of work
  /// Radius of the windows for fitting normals, in mean spacings of the scan's points; absent:
  /// chosen by the scene's noise, 2 to 7.
  std::optional<float> normal_window{};
  VoteOptions vote{};
  /// Options of voting in later rounds, which have less to search but harder objects to find: small
  /// objects in strong noise need pairs from farther apart, occluded ones more references.
  VoteOptions later{.radius = 0.7F, .reference_share = 0.2F, .max_votes = 30000};
  MatchOptions match{};
  PoseOptions pose{};
  VerifyStageOptions verify{};
  float min_score = 0.8F;  ///< minimum score of reported detections
  /// Detections with scores from this value to min_score are reported too, 0..1; meant for curves
  /// over the score. They are chosen after the others and do not change them.
  std::optional<float> doubtful_score{};
  std::uint32_t max_instances = 100;  ///< maximum number of detections per model
  /// Maximum number of rejected poses per model to report, with reasons.
  std::uint32_t max_rejected = 0;
  PlaceQuestion explain{};  ///< answered in SceneResult::explanation
  /// Require that the probability of this exact pose, score * pose_share, is at least min_score.
  bool require_pose = false;
  /// Require that the probability of the model named first, score * identity, is at least min_score.
  bool require_identity = false;
  /// Largest standard deviation of a position, in its least certain direction; less certain
  /// detections are ambiguous [scene file's unit]. Absent: any.
  std::optional<float> max_sigma{};
  std::vector<std::string> models{};  ///< names of the models to search for; empty: all
  PoseLimits limits{};
  /// Expected poses. They are tested before any voting; voting then searches only what they leave
  /// unexplained.
  std::vector<ExpectedPose> expected{};
  ImprovementSet ablated{};  ///< parts to switch off, to measure their contribution
  bool operator==(const RecognizeOptions&) const = default;
};

/// The names of the search strategies.
template <>
std::span<const Choice> choices_of<Search>();
/// The names of the detectors.
template <>
std::span<const Choice> choices_of<Detector>();
/// The names of the grouping methods.
template <>
std::span<const Choice> choices_of<Grouping>();
/// All options of recognition.
template <>
std::span<const Option<RecognizeOptions>> options_of<RecognizeOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const RecognizeOptions& options);

}  // namespace trivet
