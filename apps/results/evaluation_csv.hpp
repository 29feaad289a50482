/// An evaluation as tables for spreadsheets and statistics programs.
#pragma once

#include <filesystem>
#include <optional>
#include <span>

#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"

namespace trivet::apps {

/// Writes these files into a folder, each whole or not at all:
///
/// instances.csv   one row per truth: its known properties, and the detection that found it
/// detections.csv  one row per detection, reported or not: its verdict and its errors
/// summary.csv     one row per sum: over all, by occlusion, clutter, visible fraction, model
///
/// Fields after RFC 4180; empty if a number is unknown. Errors: cannot_create, io.
Result<void> write_evaluation_csv(const std::filesystem::path& folder, const Manifest& manifest,
                                  const Evaluation& evaluation, const BopScores& bop,
                                  std::span<const std::optional<SceneResult>> results);

}  // namespace trivet::apps
