#include "engine/loaded_library/recognizer.hpp"

#include <utility>

#include "engine/common/made_once.hpp"
#include "engine/common/parallel.hpp"
#include "engine/libraries/index_features.hpp"
#include "engine/loaded_library/find_look_alikes.hpp"
#include "engine/loaded_library/surface_cache.hpp"
#include "kernels/surfaces/visibility.hpp"
#include "storage/common/stop.hpp"

namespace trivet {
namespace {

constexpr std::size_t kSurfaceShare = 4;  // ray-tracing trees may use a fourth of the memory

using LookAlikes = engine::MadeOnce<Result<std::vector<engine::LookAlike>>>;
using NearCopies = engine::MadeOnce<Result<std::vector<engine::NearCopy>>>;

}  // namespace

struct Recognizer::Parts {
  Parts(std::size_t num_models, const MemoryBound& memory)
      : surfaces(memory.bytes / kSurfaceShare),
        look_alikes(new LookAlikes[num_models]),
        near_copies(new NearCopies[num_models]) {}

  engine::SurfaceCache surfaces;
  engine::MadeOnce<Result<FeatureLevels>> index;
  engine::MadeOnce<Result<std::vector<kernels::ShapeFrame>>> frames;
  std::unique_ptr<LookAlikes[]> look_alikes;
  std::unique_ptr<NearCopies[]> near_copies;
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
    if (library_.shape(model).num_triangles == 0) {
      TRIVET_TRY_ASSIGN(const ModelSamples* const own, library_.samples(model));
      return kernels::RayScene::from_discs(
          own->samples, own->sample_normals,
          kernels::kCloudRadius * library_.models[model].sample_spacing);
    }
    TRIVET_TRY_ASSIGN(const ModelSurface* const own, library_.surface(model));
    return kernels::RayScene::from_mesh(own->vertices, own->triangles);
  });
}

// Data computed from all models serves all scenes. Its computation completes even if the first
// caller is asked to stop; if each caller restarted it, it would never finish.

Result<const FeatureLevels*> Recognizer::features() const {
  if (!library_.index.empty()) return &library_.index;
  const Result<FeatureLevels>& index = parts_->index.get([&]() -> Result<FeatureLevels> {
    const StopScope for_all(nullptr);
    TRIVET_TRY_ASSIGN(FeatureIndex levels, engine::index_features(library_));
    return FeatureLevels(std::move(levels));
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
  const Result<std::vector<engine::LookAlike>>& found = parts_->look_alikes[model].get(
      [&] { return engine::find_look_alikes(library_, *frames, model); });
  if (!found) return found.error();
  return &*found;
}

Result<const std::vector<engine::NearCopy>*> Recognizer::near_copies(std::uint32_t model) const {
  const Result<const std::vector<engine::LookAlike>*> alike = look_alikes(model);
  if (!alike) return alike.error();
  const Result<std::vector<engine::NearCopy>>& found = parts_->near_copies[model].get(
      [&] { return engine::find_near_copies(library_, **alike, model); });
  if (!found) return found.error();
  return &*found;
}

void Recognizer::make_ready() const {
  std::size_t data = 0, trees = 0;
  for (std::uint32_t m = 0; m < library_.models.size(); ++m) {
    const ModelShape shape = library_.shape(m);
    data += shape.bytes;
    trees += kernels::RayScene::memory_bytes(shape.num_triangles > 0 ? shape.num_triangles
                                                                     : shape.num_samples);
  }
  const std::size_t share = memory_.bytes / kSurfaceShare;
  if (trees > share || data > memory_.bytes - share) return;
  engine::for_each_index(library_.models.size(), [&](std::size_t k) {
    const auto model = static_cast<std::uint32_t>(k);
    if (library_.shape(model).has_pairs()) (void)library_.pairs(model);
    if (library_.samples(model)) (void)surface(model);
  });
}

void Recognizer::release_memory() const {
  library_.release_memory(memory_.bytes - memory_.bytes / kSurfaceShare);
}

}  // namespace trivet
