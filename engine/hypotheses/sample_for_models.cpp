#include "engine/hypotheses/sample_for_models.hpp"

#include <algorithm>

namespace trivet::engine {

SceneSample sample_for_models(const Library& library, const PreparedScene& scene, float step,
                              std::span<const std::uint32_t> models, LargePlanes large_planes) {
  float largest = 0;
  for (const std::uint32_t m : models) largest = std::max(largest, library.models[m].diameter);
  return sample_scene(scene, step, largest, large_planes);
}

}  // namespace trivet::engine
