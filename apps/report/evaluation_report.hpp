/// A page that presents the results of an evaluation for review.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "apps/results/missed_whys.hpp"
#include "engine/common/progress.hpp"
#include "engine/evaluation/bop_scores.hpp"
#include "engine/evaluation/evaluate.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::apps {

struct ReportInput {
  const Manifest& manifest;
  std::span<const EvaluationMesh> meshes;
  const Evaluation& evaluation;
  const BopScores& bop;
  std::span<const std::optional<SceneResult>> results;
  std::string source;  ///< the library or the evaluated file of detections
  MissedWhys whys{};   ///< reasons, if requested
};

/// Writes folder/index.html: the result in words, tables, curves over the score, close-ups of
/// missed and wrong instances, then of correct ones, then every scene. The page needs no network.
/// Its pictures are embedded while they make up to about 20 MB, else they are in folder/pictures.
/// The page appears whole or not at all.
/// Errors: of reading and drawing the scenes; cannot_create, io; resumable when stopped.
Result<void> write_report(const std::filesystem::path& folder, const ReportInput& input,
                          const Progress& progress);

}  // namespace trivet::apps
