/// Comparison of detections with the ground truth of a manifest.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/evaluation/evaluation_meshes.hpp"
#include "engine/evaluation/score_curves.hpp"
#include "engine/results/recognize_result.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// Classification of a detection.
enum class Verdict {
  right,    ///< the first to find a truth that counts
  wrong,    ///< false positive: no truth is there, or one that is already found
  neutral,  ///< counts neither way: an ignored truth, or a model that is not scored
};

inline constexpr double kMaxAdd = 0.1;  ///< [diameters]

struct JudgedDetection {
  std::size_t detection = 0;  ///< index in the scene's result
  Verdict verdict = Verdict::wrong;
  bool reported = true;  ///< whether it reaches the threshold; others contribute to the curves only
  bool found = false;    ///< whether it is the first to find `truth`
  bool misnamed = false;  ///< whether it is wrong, but another of its candidates is there
  /// Index in the scene's truth: the one found, or else the nearest of its model by the errors;
  /// absent if the scene has none of its model.
  std::optional<std::size_t> truth;
  double translation_error = 0;  ///< error of the model's center [diameters]
  double rotation_error_deg = 0;
  double add = 0;  ///< mean distance of the vertices [diameters]
};

/// Result for a truth.
struct TruthOutcome {
  bool counts = true;  ///< whether it is neither ignored nor of a model that is not scored
  /// Whether a reported detection has its model among its candidates, in its place.
  bool among_candidates = false;
  std::optional<std::size_t> found_by;  ///< index in `detections`, reported or not
};

/// Sums over truths that count, and over reported detections.
struct Tally {
  std::size_t instances = 0, right = 0, add_right = 0, false_positives = 0;
  /// Truths that a reported detection has among its candidates, named first or not.
  std::size_t among_candidates = 0;
  /// False positives that have a truth among their candidates, and so only the wrong name.
  std::size_t misnamed = 0;
  double recall() const noexcept;     ///< 0 without instances
  double precision() const noexcept;  ///< 0 without detections that count
};

using Tallies = std::vector<std::pair<std::string, Tally>>;

struct SceneEvaluation {
  bool missing = false;  ///< whether there is no result; its truths count as not found
  Tally tally;
  std::vector<JudgedDetection> detections;  ///< sorted by falling score
  std::vector<TruthOutcome> truths;         ///< sorted as in the manifest
  std::vector<std::size_t> missed;          ///< truths that count and were not found
};

/// Seconds of one stage, over the scenes with measurements.
struct StageSeconds {
  std::string stage;
  double median = 0, p95 = 0;  ///< quantiles, linearly interpolated
};

struct Evaluation {
  Tally total;
  std::size_t num_missing = 0;  ///< scenes without a result
  /// Rising, without false positives; empty if no truth has the property.
  Tallies by_occlusion, by_clutter, by_visible_fraction;
  Tallies by_model;                                ///< sorted as in the manifest
  std::optional<double> median_translation_error;  ///< over correct detections [diameters]
  std::optional<double> median_rotation_error_deg;
  std::vector<StageSeconds> seconds;       ///< one per stage, then "total"
  PrecisionRecall curve;                   ///< over all detections that count, reported or not
  std::optional<Calibration> calibration;  ///< over the same detections
  std::vector<SceneEvaluation> scenes;     ///< sorted as in the manifest
};

/// Judge the detections of each scene.
///
/// A detection is correct if, at best over the symmetries that the manifest declares, the center of
/// the model's bounding box is off by less than a tenth of the diameter and the rotation by less
/// than 12 degrees. The turn about a free axis is ignored. Each truth is found once. Detections
/// choose in the order of falling score, each the truth that it fits best, so that no detection
/// changes the truth found by one with a higher score. The model named first must be right; a truth
/// that is another candidate, within the same limits, is counted apart. An ignored truth may be found or not.
/// Detections of models that are not scored never count.
///
/// meshes        meshes of the manifest's models (read_evaluation_meshes)
/// results       one per scene of the manifest, poses in its unit; absent if recognition did not
///               run
/// min_score     minimum for reported detections; only these contribute to tallies and medians
/// require_pose, require_identity  whether to compare min_score and the curves' thresholds with
///               score times pose_share, identity, or both, not with the score
/// Errors: bad_data (the manifest scores a model that it does not list).
/// Source: Drost et al., CVPR 2010, section 5 (limits); Hinterstoisser et al., ACCV 2012 (ADD).
Result<Evaluation> evaluate(const Manifest& manifest, std::span<const EvaluationMesh> meshes,
                            std::span<const std::optional<SceneResult>> results,
                            float min_score = -std::numeric_limits<float>::infinity(),
                            bool require_pose = false, bool require_identity = false);

}  // namespace trivet
