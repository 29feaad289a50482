/// Why truths were missed.
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

/// By scene and truth, a sentence without its subject, the model.
using MissedWhys = std::map<std::pair<std::size_t, std::size_t>, std::string>;

/// Ask of each missed truth why its model is not found there, at its surface's point nearest to the
/// sensor: its scene is recognized once more. Truths of models without a mesh, or that were not
/// looked for, are left out. Errors: of recognize.
Result<MissedWhys> explain_missed(const Recognizer& recognizer, const Manifest& manifest,
                                  std::span<const EvaluationMesh> meshes,
                                  const Evaluation& evaluation, const RecognizeOptions& options,
                                  const Progress& progress);

/// Put them into what evaluation_json gave, as `why` of each missed truth.
void add_whys(const Evaluation& evaluation, const MissedWhys& whys,
              nlohmann::ordered_json& document);

}  // namespace trivet::apps
