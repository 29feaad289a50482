/// What a manifest gives to training, to recognition and to scoring.
#pragma once

#include <string>
#include <vector>

#include "engine/scene/read_scene.hpp"
#include "engine/training/train.hpp"
#include "storage/datasets/manifest.hpp"

namespace trivet {

/// The models as training takes them, in the manifest's unit.
std::vector<ModelSource> models_of(const Manifest& manifest);

/// The scenes as recognition takes them: never their truth.
std::vector<SceneInput> scenes_of(const Manifest& manifest, LengthUnit library_unit);

/// The names of the models that count, in the manifest's order; all, where it names none.
std::vector<std::string> scored_models(const Manifest& manifest);

}  // namespace trivet
