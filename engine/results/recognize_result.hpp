/// Result of recognizing a scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/options/method.hpp"
#include "engine/results/camera_check.hpp"
#include "engine/results/explanation.hpp"
#include "engine/results/rejected_pose.hpp"
#include "engine/results/scene_view.hpp"
#include "engine/results/stage_times.hpp"
#include "kernels/scans/sensor_model.hpp"
#include "kernels/scoring/pose_score.hpp"
#include "kernels/verification/pose_covariance.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Range of turns about an axis of the model, relative to a pose.
struct TurnExtent {
  Symmetry::Axis axis;  ///< in the model's frame, in the scene file's unit
  /// [rad]; if they span a full turn, or one period of the symmetry, any turn is possible.
  float low = 0, high = 0;
};

/// What tells a candidate from the first one, with the first one in the pose of the detection.
struct CandidateDifference {
  Eigen::Vector3f center{0, 0,
                         0};  ///< of the region where the surfaces differ, in the scene's frame
  float size = 0;             ///< diameter of that region, in the scene file's unit
  float deviation = 0;        ///< largest distance of the surfaces there, in the same unit
  /// Unit vector from the region towards where most of it would be seen from, in the scene's frame.
  Eigen::Vector3f look_from{0, 0, 0};
};

/// A model that may be what was detected.
struct Candidate {
  std::string model;
  /// Probability that it is this model, if it is any of the candidates, 0..1. All sum up to 1.
  float share = 1;
  /// Log odds that it is this model rather than the first candidate, by the pixels where they
  /// differ, <= 0.
  double log_odds = 0;
  /// Rays that measure where they differ: both predict different depths, and something was measured
  /// that hides neither.
  std::size_t rays = 0;
  Pose T_scene_model = Pose::Identity();  ///< its own pose at this place, in the cloud's frame
  std::optional<CandidateDifference> differs{};  ///< absent for the first candidate
};

/// A detected object.
struct Detection {
  std::string model;  ///< the likeliest of the candidates
  /// Probability that the object, which is one of the candidates, is here, in this pose or in one
  /// that the scan cannot distinguish from it, 0..1.
  float score = 0;
  Pose T_scene_model;  ///< maps model points to points of the cloud, in the scene file's unit
  /// Share of the model's whole silhouette where the measurements agree with it.
  float visible_fraction = 0;
  /// Share of the measured silhouette where the sensor saw through the object.
  float violation = 0;
  float contour = 0;  ///< share of the outline beyond which the scene does not continue
  /// Root mean square of the distances between both surfaces where they agree, in the scene file's
  /// unit.
  float rmse = 0;
  /// Root mean square of what neighboring distances share beyond the scan's correlated noise, in the
  /// same unit: how far the object, as measured, is off its model.
  float deviation = 0;
  kernels::ScoreParts parts{};  ///< components of the score
  /// How far off the pose may be, along and about the model's axes, in the scene file's unit. Zero
  /// if the pose was not tested by rays.
  kernels::PoseCovariance covariance = kernels::PoseCovariance::Zero();
  /// Other poses of the model at this place that the scan cannot distinguish from this one.
  std::vector<Pose> alternatives{};
  /// Models that the object may be by falling share, its own first; empty if unknown.
  std::vector<Candidate> candidates{};
  Source source = Source::ppf;        ///< source that proposed the pose
  float pose_share = 1;               ///< share of the score that belongs to this exact pose, 0..1
  std::optional<TurnExtent> turns{};  ///< indistinguishable turns about an axis of near symmetry
  float hidden_fraction = 0;   ///< share of the whole silhouette occluded by something nearer
  float outside_fraction = 0;  ///< share of the whole silhouette beyond the borders of the scan

  bool is_uncertain = false;  ///< whether the position is less certain than max_sigma allows

  /// Whether the object may as well be in another pose.
  bool is_ambiguous() const noexcept { return !alternatives.empty() || is_uncertain; }
  /// Probability that the object is of this model, if it is here.
  float identity() const noexcept { return candidates.empty() ? 1 : candidates.front().share; }
  /// Probability that the object is here in this exact pose.
  float pose_score() const noexcept { return score * pose_share; }
  /// What min_score is held against, by require_pose and require_identity (RecognizeOptions).
  float asked_score(bool require_pose, bool require_identity) const noexcept {
    return score * (require_pose ? pose_share : 1) * (require_identity ? identity() : 1);
  }
};

/// Properties of the scene and cost of recognizing it.
struct SceneStats {
  /// Kind and viewpoint of the scan; absent with too few measurements.
  std::optional<SceneView> view{};
  StageTimes times;
  double total_seconds = 0;
  std::size_t num_points = 0;     ///< finite points of the scene
  std::size_t num_invalid = 0;    ///< invalid points dropped when reading
  std::size_t num_stray = 0;      ///< points left out because they lie far beyond all others
  Eigen::Vector3f size{0, 0, 0};  ///< extent along the axes, in the scene file's unit
  float noise = 0;  ///< measured standard deviation of the surface, in the scene file's unit
  /// Error model of the sensor, with lengths in the scene file's unit; absent for closed surfaces.
  std::optional<kernels::SensorModel> sensor{};
  std::optional<CameraCheck> camera_check{};  ///< present for depth images
  std::uint64_t num_references = 0, num_pairs = 0, num_votes = 0, num_hypotheses = 0,
                num_refined = 0, num_examined = 0;
};

/// Poses are in the cloud's frame; in_file_frame(pose, offset) converts them to the frame of the
/// scene's file.
struct SceneResult {
  std::vector<Detection> detections;   ///< sorted by falling score, then by model name
  std::vector<RejectedPose> rejected;  ///< sorted by falling score; no two poses of one placement
  /// Explanation of the place that the user asked about.
  std::optional<PlaceExplanation> explanation{};
  SceneStats stats;
  Eigen::Vector3d offset{0, 0, 0};  ///< offset of the cloud (Cloud::offset)
};

}  // namespace trivet
