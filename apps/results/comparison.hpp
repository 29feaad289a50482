/// Two results over the same scenes, side by side.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/results/detections_json.hpp"
#include "engine/evaluation/compare_paired.hpp"
#include "engine/evaluation/match_detections.hpp"
#include "storage/common/result.hpp"

namespace trivet::apps {

/// What a result tells of a scene.
struct ComparedScene {
  std::string name;
  std::optional<double> seconds;
  std::vector<Detection> detections;  ///< reported ones, in the frame of a cloud with `offset`
  Eigen::Vector3d offset{0, 0, 0};
  // Of results of `trivet evaluate`, which have no poses:
  std::vector<std::optional<std::size_t>> truths;  ///< that each detection found, if any
  std::vector<std::size_t> missed;                 ///< truths that count and were not found
};

struct ComparedResult {
  std::string file;
  bool has_truth = false;  ///< it is of `trivet evaluate`
  std::vector<ComparedScene> scenes;
};

/// A result of `trivet recognize --json` or `trivet evaluate --json`, or a folder of such files, as
/// the runs of a session. Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<ComparedResult> read_compared(const std::string& file);

/// Of one scene: indices of detections.
struct SceneComparison {
  std::vector<DetectionMatch> both;
  std::vector<std::size_t> only_a, only_b;    ///< with truth: right ones alone
  std::vector<std::size_t> false_a, false_b;  ///< only with truth
  std::size_t neither = 0;                    ///< truths that none found; only with truth
};

struct Comparison {
  ComparedResult a, b;  ///< with their scenes in the order of a
  std::vector<SceneComparison> scenes;
  std::optional<PairedComparison> paired;  ///< only with truth
  std::string measure;                     ///< of what is the same, in words
};

/// Compare results over the same scenes: with truth, by which truths were found; else by poses that
/// are alike.
///
/// matcher  null: results with truth need none
/// Errors: bad_data (other scenes, or only one has truth), usage (no matcher, and no truth).
Result<Comparison> compare_results(ComparedResult a, ComparedResult b, const PoseMatcher* matcher,
                                   std::string measure);

nlohmann::ordered_json comparison_json(const Comparison& comparison);
std::string comparison_text(const Comparison& comparison);

}  // namespace trivet::apps
