/// A page that shows what was found, for people to judge.
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
  std::string source;  ///< the library or the file of detections that was judged
  MissedWhys whys{};   ///< where that was asked
};

/// Write folder/index.html: the result in words, tables, curves over the score, what was missed or
/// wrong as close-ups, then right ones, then every scene. The page needs no network; its pictures
/// are within it while that makes up to about 20 MB, else in folder/pictures. It appears whole or
/// not at all. Errors: of reading and drawing the scenes; cannot_create, io; resumable when
/// stopped.
Result<void> write_report(const std::filesystem::path& folder, const ReportInput& input,
                          const Progress& progress);

}  // namespace trivet::apps
