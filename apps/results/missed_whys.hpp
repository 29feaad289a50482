/// Reasons why truths were missed.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <utility>

#include "engine/evaluation/evaluate.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/common/result.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet::apps {

/// A sentence without its subject, the model; keyed by scene and truth.
using MissedWhys = std::map<std::pair<std::size_t, std::size_t>, std::string>;

/// Explains for each missed truth why its model is not found at the point of its surface that is
/// nearest to the sensor. Its scene is recognized once more. Truths of models without a mesh, or
/// that were not searched for, are left out. Errors: of recognize.
Result<MissedWhys> explain_missed(const Recognizer& recognizer, const Manifest& manifest,
                                  std::span<const EvaluationMesh> meshes,
                                  const Evaluation& evaluation, const RecognizeOptions& options,
                                  const Progress& progress);

/// Adds the reasons to the output of evaluation_json, as `why` of each missed truth.
void add_whys(const Evaluation& evaluation, const MissedWhys& whys,
              nlohmann::ordered_json& document);

}  // namespace trivet::apps
