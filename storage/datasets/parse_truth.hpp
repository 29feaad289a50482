/// What a manifest says of one object of a scene.
#pragma once

#include "storage/datasets/manifest.hpp"
#include "storage/files/json_file.hpp"

namespace trivet {

/// "model", "T_scene_model", and what else a manifest may tell of it. Throws JsonFault.
TruthInstance parse_truth(const JsonNode& node);

}  // namespace trivet
