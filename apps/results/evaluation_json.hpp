/// An evaluation as JSON and as a table for people.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// "right", "wrong" or "neutral".
const char* verdict_name(Verdict verdict);

/// Sums, medians, curves, and for each scene what every detection turned out to be.
nlohmann::ordered_json evaluation_json(const Manifest& manifest, const Evaluation& evaluation,
                                       const BopScores& bop,
                                       std::span<const std::optional<SceneResult>> results);

/// The same sums and medians as lines of text.
std::string evaluation_table(const Evaluation& evaluation, const BopScores& bop);

}  // namespace trivet::apps
