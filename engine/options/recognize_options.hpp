/// What recognition can be told. Ranges, defaults and meanings as a user sees them are those of
/// options_of<RecognizeOptions>().
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

/// Of voting by point pairs.
struct VoteOptions {
  /// Of the ball around a reference point that its pairs end in [diameters]. Smaller is faster and
  /// bears more occlusion, larger bears more noise.
  float radius = 0.4F;
  float reference_share = 0.1F;         ///< of the sampled scene points
  std::uint32_t max_references = 4000;  ///< per size of models
  float neighbor_share = 0;             ///< of a bin, at its ends: the adjoining cell votes too
  std::uint32_t max_votes = 40000;      ///< per reference point and model; fullest cells go first
  std::uint32_t max_peaks = 2;          ///< poses per reference point
  float peak_share = 0.9F;              ///< of the best of a reference point: lower ones go
  bool operator==(const VoteOptions&) const = default;
};

/// Which points of a scene are described.
enum class Detector : std::uint8_t {
  uniform,  ///< spread evenly
  iss,      ///< intrinsic shape signatures
  harris,   ///< Harris 3D
};

/// How matches of a model become poses.
enum class Grouping : std::uint8_t {
  frames,       ///< each gives one, by its two frames
  consistency,  ///< matches whose distances agree give one together
  ransac,       ///< so do those that a pose of three takes to their places
};

/// Of Tri-Spin-Images. The defaults match by nearest neighbors; a threshold on their distance or
/// on their ratio to the second nearest are the other strategies of the thesis.
struct MatchOptions {
  Detector detector = Detector::uniform;
  float spacing = 3;                    ///< of a scene's keypoints [resolutions of the models]
  std::uint32_t max_keypoints = 10000;  ///< of more, so many spread over all are described
  kernels::FrameLimits limits{};        ///< keypoints below are left out: flat, at a border, unsure
  std::uint32_t num_neighbors = 3;      ///< features of models that each is matched with
  std::uint32_t num_lists = 4;  ///< of the index that it is looked for in; more are more exact
  /// Largest distance of matched features.
  float max_distance = std::numeric_limits<float>::infinity();
  /// Largest ratio of it to that of the nearest feature of another model or of a place farther than
  /// half a support; 1: none is too large.
  float max_ratio = 1;
  bool weigh_by_ratio = false;  ///< a match has 1 - ratio votes, else 1
  Grouping grouping = Grouping::frames;
  bool operator==(const MatchOptions&) const = default;
};

/// From hypotheses to poses: how many are followed.
struct PoseOptions {
  float cluster_translation = 0.07F;  ///< limit between poses of a cluster, in diameters
  float cluster_rotation_deg = 15;    ///< ... and in degrees
  std::uint32_t max_clusters = 300;   ///< kept per model for the first verification
  /// Clusters with less than this share of the best one's votes are dropped; the thesis takes 0.5.
  float min_cluster_share = 0;
  std::uint32_t max_refined = 60;   ///< candidates per model that are refined
  std::uint32_t max_examined = 40;  ///< refined candidates per model that are tested by rays
  /// Of searching, later ones on what is not yet explained; 0 to test expected poses only.
  std::uint32_t rounds = 2;
  bool operator==(const PoseOptions&) const = default;
};

/// When a pose agrees with the scan.
struct VerifyStageOptions {
  float tolerance_sigmas = 3;          ///< agreement in standard deviations of the scene's noise
  float tolerance_diameters = 0.016F;  ///< ... but at least this share of the diameter
  float max_overlap = 0.4F;  ///< share of a detection's pixels that better ones may explain
  bool operator==(const VerifyStageOptions&) const = default;
};

/// What doubtful_score is set to for curves over the score and for files that take every pose.
inline constexpr float kLowestKeptScore = 0.1F;

/// How the models of a library share the work.
enum class Search : std::uint8_t {
  automatic,   ///< large libraries within a budget, small ones exhaustively
  exhaustive,  ///< each model on its own
};

/// A place of the scene of which recognition tells why models are found there or not.
struct PlaceQuestion {
  std::optional<Eigen::Vector3d> point{};  ///< in the frame and unit of the scene's file
  std::vector<std::string> models{};       ///< that are explained; empty: all that come near
  bool operator==(const PlaceQuestion&) const = default;
};

/// All that recognition can be told; the defaults are the balanced preset.
struct RecognizeOptions {
  Method method = Method::fused;
  Search search = Search::automatic;
  float budget = 1;  ///< of searching large libraries: all counts of work are multiplied by it
  /// Radius of the windows that normals are fitted to, in mean spacings of the scan's points;
  /// absent: as wide as the scene's noise asks for, 2 to 7.
  std::optional<float> normal_window{};
  VoteOptions vote{};
  /// Of later rounds, which have less to search and the harder ones to find: small objects in
  /// strong noise need pairs from farther apart, hidden ones more references.
  VoteOptions later{.radius = 0.7F, .reference_share = 0.2F, .max_votes = 60000};
  MatchOptions match{};
  PoseOptions pose{};
  VerifyStageOptions verify{};
  float min_score = 0.8F;  ///< detections below are not reported
  /// Detections from this score to min_score are reported too, 0..1: for curves over the score.
  /// They are chosen after the others, which they do not change.
  std::optional<float> doubtful_score{};
  std::uint32_t max_instances = 100;  ///< per model
  std::uint32_t max_rejected = 0;     ///< poses per model that are told with the reason
  PlaceQuestion explain{};            ///< answered in SceneResult::explanation
  /// Report only detections of which this very pose has min_score: score * pose_share.
  bool require_pose = false;
  std::vector<std::string> models{};  ///< names to look for; empty: all
  PoseLimits limits{};
  /// Tested before any voting, which is then for what they leave unexplained.
  std::vector<ExpectedPose> expected{};
  ImprovementSet ablated{};  ///< left out, to measure what they are worth
  bool operator==(const RecognizeOptions&) const = default;
};

/// The names of the ways to search.
template <>
std::span<const Choice> choices_of<Search>();
/// The names of the detectors.
template <>
std::span<const Choice> choices_of<Detector>();
/// The names of the ways to group matches.
template <>
std::span<const Choice> choices_of<Grouping>();
/// Every option of recognition.
template <>
std::span<const Option<RecognizeOptions>> options_of<RecognizeOptions>();

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const RecognizeOptions& options);

}  // namespace trivet
