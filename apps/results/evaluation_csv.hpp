/// An evaluation as tables for spreadsheets and statistics programs.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// Write into a folder, each file whole or not at all:
/// instances.csv   one row a truth: what is known of it, and the detection that found it
/// detections.csv  one row a detection, reported or not: what it turned out to be, and its errors
/// summary.csv     one row a sum: over all, by occlusion, clutter, visible fraction, model
/// Fields after RFC 4180; empty where a number is not known. Errors: cannot_create, io.
Result<void> write_evaluation_csv(const std::filesystem::path& folder, const Manifest& manifest,
                                  const Evaluation& evaluation, const BopScores& bop,
                                  std::span<const std::optional<SceneResult>> results);

}  // namespace trivet::apps
