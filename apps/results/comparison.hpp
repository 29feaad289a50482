/// Comparison of two results over the same scenes.
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

/// The result for one scene.
struct ComparedScene {
  std::string name;
  std::optional<double> seconds;
  std::vector<Detection> detections;  ///< reported; in the frame of a cloud with `offset`
  Eigen::Vector3d offset{0, 0, 0};
  // Of results of `trivet evaluate`, which have no poses:
  std::vector<std::optional<std::size_t>> truths;  ///< truth found by each detection, if any
  std::vector<std::size_t> missed;                 ///< counted truths that were not found
};

struct ComparedResult {
  std::string file;
  bool has_truth = false;  ///< the result is one of `trivet evaluate`
  std::vector<ComparedScene> scenes;
};

/// Reads a result of `trivet recognize --json` or `trivet evaluate --json`, or a folder of such
/// files, such as the runs of a session.
/// Errors: missing_input, io, bad_data (names the JSON path of the fault).
Result<ComparedResult> read_compared(const std::string& file);

/// The comparison of one scene, as indices of detections.
struct SceneComparison {
  std::vector<DetectionMatch> both;
  std::vector<std::size_t> only_a, only_b;    ///< with truth: correct ones only
  std::vector<std::size_t> false_a, false_b;  ///< only with truth
  std::size_t neither = 0;                    ///< truths found by neither; only with truth
};

struct Comparison {
  ComparedResult a, b;  ///< with their scenes in the order of a
  std::vector<SceneComparison> scenes;
  std::optional<PairedComparison> paired;  ///< only with truth
  std::string measure;                     ///< criterion for equal poses, in words
};

/// Compares results over the same scenes: with truth, by the truths that were found; without, by
/// similar poses.
///
/// matcher  null: results with truth need none
/// Errors: bad_data (different scenes, or truth in only one result), usage (neither a matcher nor
/// truth).
Result<Comparison> compare_results(ComparedResult a, ComparedResult b, const PoseMatcher* matcher,
                                   std::string measure);

nlohmann::ordered_json comparison_json(const Comparison& comparison);
std::string comparison_text(const Comparison& comparison);

}  // namespace trivet::apps
