#include "engine/evaluation/manifest_inputs.hpp"

namespace trivet {

std::vector<ModelSource> models_of(const Manifest& manifest) {
  std::vector<ModelSource> sources;
  for (const ManifestModel& model : manifest.models) {
    sources.push_back({model.name, model.file, model.scale, model.symmetry});
  }
  return sources;
}

std::vector<SceneInput> scenes_of(const Manifest& manifest, LengthUnit library_unit) {
  std::vector<SceneInput> scenes;
  for (const ManifestScene& scene : manifest.scenes) {
    scenes.push_back({scene.file, scene.camera, scene.viewpoint, scene.closed_surface,
                      unit_scale(manifest.unit, library_unit)});
    scenes.back().unit = manifest.unit;
  }
  return scenes;
}

std::vector<std::string> scored_models(const Manifest& manifest) {
  if (!manifest.models_scored.empty()) return manifest.models_scored;
  std::vector<std::string> names;
  for (const ManifestModel& model : manifest.models) names.push_back(model.name);
  return names;
}

}  // namespace trivet
