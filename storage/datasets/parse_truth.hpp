/// Parsing of the ground truth of one object of a scene.
#pragma once

#include "storage/datasets/manifest.hpp"
#include "storage/files/json_file.hpp"

namespace trivet {

/// Parses "model", "T_scene_model" and the optional members of a manifest. Throws JsonFault.
TruthInstance parse_truth(const JsonNode& node);

}  // namespace trivet
