/// Recognize the models of a library in a scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/camera_check.hpp"
#include "engine/improvements.hpp"
#include "engine/method.hpp"
#include "engine/pose_limits.hpp"
#include "engine/progress.hpp"
#include "engine/recognizer.hpp"
#include "kernels/scans/sensor_model.hpp"
#include "kernels/spin_images/tri_spin_image.hpp"
#include "kernels/verification/examine_pose.hpp"
#include "kernels/verification/pose_score.hpp"
#include "storage/cloud.hpp"
#include "storage/result.hpp"

namespace trivet {

struct VoteOptions {
  /// Of the ball around a reference point that its pairs end in, in diameters, above 0 to 1.
  /// Smaller is faster and bears more occlusion, larger bears more noise.
  float radius = 0.4F;
  float reference_share =
      0.1F;  ///< share of the sampled scene points that vote as references, 0..1
  std::uint32_t max_references = 4000;  ///< per size of models; fewer is faster in large scenes
  float neighbor_share =
      0;  ///< outer share of a bin in which the adjoining cell votes too, 0..0.5; slower
  std::uint32_t max_votes =
      40000;  ///< per reference point and model; the fullest cells are left out; fewer is faster
  std::uint32_t max_peaks = 2;  ///< poses per reference point, 1..8
  float peak_share = 0.9F;  ///< lower peaks, relative to the best of a reference point, are dropped
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
  float spacing = 3;  ///< of a scene's keypoints [resolutions of the models], 1 to 20
  std::uint32_t max_keypoints = 10000;  ///< of more, so many spread over all are described
  kernels::FrameLimits limits{};        ///< keypoints below are left out: flat, at a border, unsure
  std::uint32_t num_neighbors = 3;      ///< features of models that each is matched with, 1 to 10
  std::uint32_t max_checks = 256;       ///< features that it is compared with; more are more exact
  /// Largest distance of matched features, above 0.
  float max_distance = std::numeric_limits<float>::infinity();
  /// Largest ratio of it to that of the nearest feature of another model or of a place farther than
  /// half a support, above 0 to 1; 1: none is too large.
  float max_ratio = 1;
  bool weigh_by_ratio = false;  ///< a match has 1 - ratio votes, else 1
  Grouping grouping = Grouping::frames;
  bool operator==(const MatchOptions&) const = default;
};

struct PoseOptions {
  float cluster_translation = 0.07F;  ///< limit between poses of a cluster, in diameters
  float cluster_rotation_deg = 15;    ///< ... and in degrees
  std::uint32_t max_clusters = 300;   ///< kept per model for the first verification
  /// Clusters with less than this share of the best one's votes are dropped, 0 to 1; the thesis
  /// takes 0.5.
  float min_cluster_share = 0;
  std::uint32_t max_refined = 60;   ///< candidates per model that are refined
  std::uint32_t max_examined = 40;  ///< refined candidates per model that are tested by rays
  /// Of searching, later ones on what is not yet explained; 0 to test expected poses only.
  std::uint32_t rounds = 2;
  bool operator==(const PoseOptions&) const = default;
};

struct VerifyStageOptions {
  float tolerance_sigmas = 3;          ///< agreement in standard deviations of the scene's noise
  float tolerance_diameters = 0.016F;  ///< ... but at least this share of the diameter
  float max_overlap =
      0.4F;  ///< share of a detection's pixels that a better one may already explain
  bool operator==(const VerifyStageOptions&) const = default;
};

struct RecognizeOptions {
  Method method = Method::fused;
  /// Radius of the windows that normals are fitted to, in mean spacings of the scan's points, 1 to
  /// 20; absent: as wide as the scene's noise asks for, 2 to 7.
  std::optional<float> normal_window{};
  VoteOptions vote{};
  /// Of later rounds, which have less to search and the harder ones to find: small objects in
  /// strong noise need pairs from farther apart, hidden ones more references.
  VoteOptions later{.radius = 0.7F, .reference_share = 0.2F, .max_votes = 60000};
  MatchOptions match{};
  PoseOptions pose{};
  VerifyStageOptions verify{};
  float min_score = 0.8F;  ///< detections below are not reported, 0..1
  /// Detections from this score to min_score are reported too, 0..1: for curves over the score.
  /// They are chosen after the others, which they do not change.
  std::optional<float> doubtful_score{};
  std::uint32_t max_instances = 100;  ///< per model
  std::uint32_t max_rejected = 0;     ///< poses per model that are told with the reason
  bool tell_claims = false;           ///< in SceneResult::claims; without doubtful_score
  /// Report only detections of which this very pose has min_score: score * pose_share.
  bool require_pose = false;
  std::vector<std::string> models{};  ///< names to look for; empty: all
  PoseLimits limits{};
  /// Tested before any voting, which is then for what they leave unexplained.
  std::vector<ExpectedPose> expected{};
  ImprovementSet ablated{};  ///< left out, to measure what they are worth
  bool operator==(const RecognizeOptions&) const = default;
};

/// Errors: usage (names the option, its range and its value).
Result<void> validate(const RecognizeOptions& options);

/// What the sensor was.
struct SceneInput {
  std::filesystem::path file{};
  std::optional<Camera> camera{};              ///< of a depth image
  std::optional<Eigen::Vector3f> viewpoint{};  ///< position of the sensor in the scene's frame
  /// No sensor: a whole surface, normals by its faces. Found by itself for a closed mesh without
  /// viewpoint; a scene whose file holds a pixel grid or a viewpoint is a scan all the same.
  bool closed_surface = false;
  double scale = 1;  ///< multiplies the file's coordinates, giving the library's unit
};

/// Turns about an axis of the model from a pose on.
struct TurnExtent {
  Symmetry::Axis axis;      ///< in the model's frame, in the scene file's unit
  float low = 0, high = 0;  ///< [rad]; apart by a whole turn, or by one of its symmetry: any
};

struct Detection {
  std::string model;
  /// Probability that the object is here, in this pose or one that the scan cannot tell from it,
  /// 0..1.
  float score = 0;
  Pose T_scene_model;           ///< model point -> scene point, in the scene file's unit
  float visible_fraction = 0;   ///< share of the model's silhouette that was measured as it says
  float violation = 0;          ///< share of what was measured there that the sensor looked through
  float contour = 0;            ///< share of the outline that the scene does not run on beyond
  float rmse = 0;               ///< across the agreeing surface, in the scene file's unit
  kernels::ScoreParts parts{};  ///< what the score is made of
  /// Other poses of the model in this place that the scan cannot tell from this one: with any, the
  /// detection is ambiguous.
  std::vector<Pose> alternatives{};
  std::vector<std::string> siblings{};  ///< other models that explain as well what is seen here
  Source source = Source::ppf;          ///< that proposed it
  float pose_share = 1;                 ///< of the score, what is this pose's, 0..1
  std::optional<TurnExtent> turns{};    ///< that the scan cannot tell apart; of a near axis

  /// Probability that the object is here in this very pose.
  float pose_score() const noexcept { return score * pose_share; }
};

enum class Rejection {
  too_low,    ///< the score, or pose_score if that is required, is below min_score
  explained,  ///< better poses already explain more than max_overlap of its pixels
  too_many,   ///< max_instances of its model are better
};

/// A pose that was tested in full but not reported.
struct RejectedPose {
  std::string model;
  float score = 0;              ///< as of a detection
  Pose T_scene_model;           ///< model point -> scene point, in the scene file's unit
  kernels::ScoreParts parts{};  ///< what the score is made of
  Rejection reason = Rejection::too_low;
  /// Index of the detection that explains most of its pixels, and what share of them: with the
  /// reason `explained`, unless that one itself was one too many; and where one that is too low
  /// lies in the place of a better one.
  std::optional<std::size_t> explained_by{};
  float explained_share = 0;
};

/// A pose that was taken, also if it is not reported: what decides between it and others in its
/// place.
struct PoseClaim {
  std::string model;
  float rank = 0;                      ///< higher ones choose first; depends on the library's unit
  kernels::ExplainedPixels explained;  ///< none where Improvement::explained is left out
  std::optional<std::size_t> detection{};  ///< index of the detection that it became
};

struct ImageSize {
  std::uint32_t width = 0, height = 0;  ///< [pixel]
  bool operator==(const ImageSize&) const = default;
};

/// What the poses that were taken claim of the images that the scene was looked at in.
struct SceneClaims {
  std::vector<ImageSize> images;
  std::vector<PoseClaim> poses;  ///< in the order of taking
};

struct SceneStats {
  StageTimes times;
  double total_seconds = 0;
  std::size_t num_points = 0;   ///< finite points of the scene
  std::size_t num_invalid = 0;  ///< dropped when reading
  float noise = 0;              ///< measured standard deviation of the surface [library unit]
  /// How the scan errs, with lengths in the scene file's unit; none of closed surfaces.
  std::optional<kernels::SensorModel> sensor{};
  std::optional<CameraCheck> camera_check{};  ///< of depth images
  std::uint64_t num_references = 0, num_pairs = 0, num_votes = 0, num_hypotheses = 0,
                num_refined = 0, num_examined = 0;
};

struct SceneResult {
  std::vector<Detection> detections;    ///< by falling score, then model name
  std::vector<RejectedPose> rejected;   ///< by falling score; no two of one placement
  std::optional<SceneClaims> claims{};  ///< if they are asked for
  SceneStats stats;
};

/// Find the models in one scene that is already in memory. Same input, same bytes for any number of
/// threads. With fewer than 50 measurements nothing is found. Errors: bad_data (sizes that cannot
/// match the library's unit), usage (unknown model name), internal (no memory for ray tracing).
Result<SceneResult> recognize(const Recognizer& recognizer, const Cloud& scene,
                              const SceneInput& input, const RecognizeOptions& options,
                              std::stop_token stop = {});

/// Read and recognize many scenes, a few in flight at a time. `emit` gets each result once, in the
/// order of the inputs, from one thread at a time. Errors: the first one met, in the order of the
/// inputs; resumable when stopped.
Result<void> recognize_all(const Recognizer& recognizer, std::span<const SceneInput> scenes,
                           const RecognizeOptions& options, const Progress& progress,
                           const std::function<void(std::size_t index, const SceneResult&)>& emit);

}  // namespace trivet
