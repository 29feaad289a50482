/// What recognition found in a scene.
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
#include "kernels/verification/pose_score.hpp"
#include "storage/data/model.hpp"

namespace trivet {

/// Turns about an axis of the model from a pose on.
struct TurnExtent {
  Symmetry::Axis axis;      ///< in the model's frame, in the scene file's unit
  float low = 0, high = 0;  ///< [rad]; apart by a whole turn, or by one of its symmetry: any
};

/// An object that was found.
struct Detection {
  std::string model;
  /// Probability that the object is here, in this pose or one that the scan cannot tell from it,
  /// 0..1.
  float score = 0;
  Pose T_scene_model;  ///< model point -> point of the cloud, in the scene file's unit
  /// Share of the model's whole silhouette that was measured as it says.
  float visible_fraction = 0;
  float violation = 0;  ///< share of what was measured there that the sensor looked through
  float contour = 0;    ///< share of the outline that the scene does not run on beyond
  /// Root mean square of the distances between both surfaces where they agree, in the scene file's
  /// unit.
  float rmse = 0;
  kernels::ScoreParts parts{};  ///< what the score is made of
  /// Other poses of the model in this place that the scan cannot tell from this one: with any, the
  /// detection is ambiguous.
  std::vector<Pose> alternatives{};
  std::vector<std::string> siblings{};  ///< other models that explain as well what is seen here
  Source source = Source::ppf;          ///< that proposed it
  float pose_share = 1;                 ///< of the score, what is this pose's, 0..1
  std::optional<TurnExtent> turns{};    ///< that the scan cannot tell apart; of a near axis
  float hidden_fraction = 0;            ///< share of the whole silhouette behind something nearer
  float outside_fraction = 0;           ///< ... beyond the borders of the scan

  /// Probability that the object is here in this very pose.
  float pose_score() const noexcept { return score * pose_share; }
};

/// What the scene was, and what recognizing it took.
struct SceneStats {
  std::optional<SceneView> view{};  ///< what saw the scene; none of too few measurements
  StageTimes times;
  double total_seconds = 0;
  std::size_t num_points = 0;     ///< finite points of the scene
  std::size_t num_invalid = 0;    ///< dropped when reading
  std::size_t num_stray = 0;      ///< left out, as they lie far beyond all others
  Eigen::Vector3f size{0, 0, 0};  ///< of the scene along its axes, in the scene file's unit
  float noise = 0;                ///< measured standard deviation of the surface, in that unit
  /// How the scan errs, with lengths in the scene file's unit; none of closed surfaces.
  std::optional<kernels::SensorModel> sensor{};
  std::optional<CameraCheck> camera_check{};  ///< of depth images
  std::uint64_t num_references = 0, num_pairs = 0, num_votes = 0, num_hypotheses = 0,
                num_refined = 0, num_examined = 0;
};

/// Poses are of the cloud; in_file_frame(pose, offset) gives them as the scene's file has them.
struct SceneResult {
  std::vector<Detection> detections;              ///< by falling score, then model name
  std::vector<RejectedPose> rejected;             ///< by falling score; no two of one placement
  std::optional<PlaceExplanation> explanation{};  ///< of the place that was asked about
  SceneStats stats;
  Eigen::Vector3d offset{0, 0, 0};  ///< of the cloud (Cloud::offset)
};

}  // namespace trivet
