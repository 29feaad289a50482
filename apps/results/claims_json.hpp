/// What the poses of a scene claim, as JSON: pixels as runs.
#pragma once

#include <nlohmann/json.hpp>

#include "engine/recognize.hpp"
#include "storage/files/json_file.hpp"

namespace trivet::apps {

/// {"images": [[width, height] ...], "poses": [{"model", "rank", "detection": index or null,
/// "square": side of what a pixel stands for, "runs": [first, number ...]} ...]}: a run are pixels
/// that are a square apart.
nlohmann::ordered_json claims_json(const SceneClaims& claims);

/// Read them back. Throws JsonFault where they break the form or these bounds: 2^26 pixels of all
/// images, and as many of all poses; detections below `num_detections`, each claimed once.
SceneClaims parse_claims(const JsonNode& node, std::size_t num_detections);

}  // namespace trivet::apps
