#include "engine/loaded_library/surface_cache.hpp"

#include <utility>

#include "engine/common/made_once.hpp"

namespace trivet::engine {

struct SurfaceCache::Slot {
  explicit Slot(std::uint32_t of_model) : model(of_model) {}

  const std::uint32_t model;
  MadeOnce<Result<Surface>> surface;  // Embree builds it with TBB
  std::size_t bytes = 0;              // memory counted in taken_
};

std::shared_ptr<SurfaceCache::Slot> SurfaceCache::slot_of(std::uint32_t model) {
  const std::lock_guard lock(mutex_);
  if (const auto found = of_model_.find(model); found != of_model_.end()) {
    slots_.splice(slots_.begin(), slots_, found->second);
    return slots_.front();
  }
  slots_.push_front(std::make_shared<Slot>(model));
  of_model_.emplace(model, slots_.begin());
  return slots_.front();
}

Result<SurfaceCache::Surface> SurfaceCache::get(
    std::uint32_t model, const std::function<Result<kernels::RayScene>()>& make) {
  const std::shared_ptr<Slot> slot = slot_of(model);
  bool is_new = false;
  const Result<Surface>& surface = slot->surface.get([&]() -> Result<Surface> {
    is_new = true;
    TRIVET_TRY_ASSIGN(kernels::RayScene made, make());
    return std::make_shared<const kernels::RayScene>(std::move(made));
  });
  if (is_new && surface) {
    const std::lock_guard lock(mutex_);
    slot->bytes = (*surface)->memory_bytes();
    used_bytes_ += slot->bytes;
    make_room();
  }
  return surface;
}

void SurfaceCache::make_room() {
  for (auto at = slots_.end(); used_bytes_ > bytes_ && at != slots_.begin();) {
    --at;
    if (at == slots_.begin() || (*at)->bytes == 0) continue;  // just built, or not built yet
    used_bytes_ -= (*at)->bytes;
    of_model_.erase((*at)->model);
    at = slots_.erase(at);
  }
}

}  // namespace trivet::engine
