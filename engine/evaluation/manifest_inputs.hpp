/// Input from a manifest for training, recognition and scoring.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/read_scene.hpp"
#include "engine/training/train.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// The models as input for training, in the manifest's unit.
std::vector<ModelSource> models_of(const Manifest& manifest);

/// The scenes as input for recognition, never with their ground truth.
std::vector<SceneInput> scenes_of(const Manifest& manifest, LengthUnit library_unit);

/// The names of the scored models, in the manifest's order; all if it names none.
std::vector<std::string> scored_models(const Manifest& manifest);

}  // namespace trivet
