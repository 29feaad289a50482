/// Hold detections against the truth of a manifest.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "engine/progress.hpp"
#include "engine/recognise.hpp"
#include "storage/library.hpp"
#include "storage/manifest.hpp"
#include "storage/result.hpp"

namespace trivet {

/// What a detection turned out to be.
enum class Verdict {
  right,    ///< the first to find a truth that counts
  wrong,    ///< no truth is there, or one that is found already: a false positive
  neutral,  ///< counts neither way: an ignored truth, or a model that is not scored
};

struct JudgedDetection {
  std::size_t detection = 0;  ///< index in the scene's result
  Verdict verdict = Verdict::wrong;
  std::optional<std::size_t> truth;  ///< index in the scene's truth; none when wrong
  double translation_error = 0;      ///< of the model's middle, in diameters; for right ones
  double rotation_error_deg = 0;
  bool add_right = false;  ///< mean distance of the vertices below a tenth of the diameter
};

/// Sums over truths that count, and over detections.
struct Tally {
  std::size_t instances = 0, right = 0, add_right = 0, false_positives = 0;
  double recall() const noexcept;  ///< 0 without instances
};

struct SceneEvaluation {
  bool missing = false;  ///< there is no result: its truths count as not found
  Tally tally;
  std::vector<JudgedDetection> detections;  ///< by falling score
  std::vector<std::size_t> missed;          ///< truths that count and were not found
};

struct Evaluation {
  Tally total;
  std::size_t num_missing = 0;                              ///< scenes without a result
  std::vector<std::pair<std::string, Tally>> by_occlusion;  ///< rising; without false positives
  std::vector<std::pair<std::string, Tally>> by_model;      ///< in the manifest's order
  std::optional<double> median_translation_error;           ///< of right detections, in diameters
  std::optional<double> median_rotation_error_deg;
  StageTimes median_seconds;            ///< by stage, then "total"; over the scenes
  std::vector<SceneEvaluation> scenes;  ///< as in the manifest
};

/// Judge the detections of each scene.
///
/// A detection is right when, at best over the symmetries that the manifest declares, the middle of
/// the model's bounding box is off by less than a tenth of the diameter and the rotation by less
/// than 12 degrees; a free axis leaves the turn about it out. Each truth is found once; detections
/// choose by falling score, each the truth it fits best. An ignored truth may be found or not.
/// Detections of models that are not scored never count. ADD: mean distance between the vertices of
/// both poses below a tenth of the diameter; to the nearest vertex (ADD-S) for a model that
/// declares a symmetry. results   one a scene of the manifest, poses in the manifest's unit; none
/// where recognition did not run Errors: bad_data (a truth's model was detected but is not in the
/// library). Source: Drost et al., CVPR 2010, section 5 (limits); Hinterstoisser et al., ACCV 2012
/// (ADD).
Result<Evaluation> evaluate(const Manifest& manifest, const Library& library,
                            std::span<const std::optional<SceneResult>> results);

/// The range that holds the true rate with a confidence of 95 %, given the successes of independent
/// trials. Whole range without trials. Source: Wilson, JASA 1927.
std::pair<double, double> wilson_interval(std::size_t successes, std::size_t trials) noexcept;

}  // namespace trivet
