/// An evaluation as JSON and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// "right", "wrong" or "neutral".
const char* verdict_name(Verdict verdict);

/// What counts as reported.
struct ScoreThreshold {
  std::optional<float> min_score{};    ///< none: all that is there
  bool require_pose = false;           ///< the very pose has it
  std::optional<float> lowest_kept{};  ///< that recognition kept, for curves and BOP's scores
};

/// Sums, medians, curves, and for each scene what every detection turned out to be.
nlohmann::ordered_json evaluation_json(const Manifest& manifest, const Evaluation& evaluation,
                                       const ScoreThreshold& threshold, const BopScores& bop,
                                       std::span<const std::optional<SceneResult>> results);

/// The same sums and medians as lines of text.
std::string evaluation_table(const Evaluation& evaluation, const BopScores& bop);

/// The threshold as a line of text. source: the library or the file that was judged.
std::string threshold_words(const ScoreThreshold& threshold, const std::string& source);

}  // namespace trivet::apps
