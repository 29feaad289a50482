/// An evaluation as JSON and as a text table.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// The name in JSON: "right", "wrong" or "neutral".
const char* verdict_name(Verdict verdict);

/// Which detections count as reported.
struct ScoreThreshold {
  std::optional<float> min_score{};    ///< none: all of the results
  bool require_pose = false;           ///< compare score x pose_share, not the score
  bool require_identity = false;       ///< compare score x identity
  std::optional<float> lowest_kept{};  ///< kept by recognition, for curves and BOP's scores
};

/// Sums, medians and curves, and the verdict of every detection of each scene.
nlohmann::ordered_json evaluation_json(const Manifest& manifest, const Evaluation& evaluation,
                                       const ScoreThreshold& threshold, const BopScores& bop,
                                       std::span<const std::optional<SceneResult>> results);

/// The same sums and medians as lines of text.
std::string evaluation_table(const Evaluation& evaluation, const BopScores& bop);

/// The threshold as a line of text.
///
/// source  the library or the evaluated file
std::string threshold_words(const ScoreThreshold& threshold, const std::string& source);

}  // namespace trivet::apps
