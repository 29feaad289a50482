#include "engine/loaded_library/recognizer.hpp"

#include <utility>

#include "engine/common/made_once.hpp"
#include "engine/libraries/index_features.hpp"
#include "engine/loaded_library/find_look_alikes.hpp"
#include "engine/loaded_library/surface_cache.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "storage/common/stop.hpp"

namespace trivet {
namespace {

constexpr std::size_t kSurfaceShare = 4;  // ray-tracing trees may use a fourth of the memory

using LookAlikes = engine::MadeOnce<std::vector<engine::LookAlike>>;

}  // namespace

struct Recognizer::Parts {
  Parts(std::size_t num_models, const MemoryBound& memory)
      : surfaces(memory.bytes / kSurfaceShare), look_alikes(new LookAlikes[num_models]) {}

  engine::SurfaceCache surfaces;
  engine::MadeOnce<Result<FeatureIndex>> index;
  engine::MadeOnce<Result<std::vector<kernels::ShapeFrame>>> frames;
  std::unique_ptr<LookAlikes[]> look_alikes;
};

Recognizer::Recognizer(Library library, const kernels::ScoreModel& score, const MemoryBound& memory)
    : library_(std::move(library)),
      score_(score),
      memory_(memory),
      parts_(new Parts(library_.models.size(), memory)) {}
Recognizer::Recognizer(Recognizer&&) noexcept = default;
Recognizer& Recognizer::operator=(Recognizer&&) noexcept = default;
Recognizer::~Recognizer() = default;

Result<std::shared_ptr<const kernels::RayScene>> Recognizer::surface(std::uint32_t model) const {
  return parts_->surfaces.get(model, [&]() -> Result<kernels::RayScene> {
    const Model& m = library_.models[model];
    const ModelPart part = m.triangles.empty() ? ModelPart::samples : ModelPart::surface;
    TRIVET_TRY(library_.check(model, part));
    if (m.triangles.empty())
      return kernels::RayScene::from_discs(m.samples, m.sample_normals,
                                           kernels::kCloudRadius * m.sample_spacing);
    return kernels::RayScene::from_mesh(m.vertices, m.triangles);
  });
}

// Data computed from all models serves all scenes. Its computation completes even if the first
// caller is asked to stop; if each caller restarted it, it would never finish.

Result<const FeatureIndex*> Recognizer::features() const {
  if (!library_.index.empty()) return &library_.index;
  const Result<FeatureIndex>& index = parts_->index.get([&] {
    const StopScope for_all(nullptr);
    return engine::index_features(library_);
  });
  if (!index) return index.error();
  return &*index;
}

Result<const std::vector<engine::LookAlike>*> Recognizer::look_alikes(std::uint32_t model) const {
  const Result<std::vector<kernels::ShapeFrame>>& frames = parts_->frames.get([&] {
    const StopScope for_all(nullptr);
    return engine::shape_frames(library_);
  });
  if (!frames) return frames.error();
  return &parts_->look_alikes[model].get(
      [&] { return engine::find_look_alikes(library_, *frames, model); });
}

void Recognizer::release_memory() const {
  library_.release_memory(memory_.bytes - memory_.bytes / kSurfaceShare);
}

}  // namespace trivet
