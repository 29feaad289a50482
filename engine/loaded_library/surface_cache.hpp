/// The ray-tracing trees of models: made when they are asked for, given back when others need room.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

#include "kernels/common/ray_scene.hpp"
#include "storage/common/result.hpp"

namespace trivet::engine {

/// May be called from many threads, also from within TBB's tasks.
class SurfaceCache {
 public:
  using Surface = std::shared_ptr<const kernels::RayScene>;

  /// bytes  that the trees may take together; what is in use stays beyond it
  explicit SurfaceCache(std::size_t bytes) : bytes_(bytes) {}

  /// The tree of a model, made by make() unless it is there; all who ask at the same time wait for
  /// one. Errors: those of make.
  Result<Surface> get(std::uint32_t model, const std::function<Result<kernels::RayScene>()>& make);

 private:
  struct Slot;
  using Slots = std::list<std::shared_ptr<Slot>>;

  std::shared_ptr<Slot> slot_of(std::uint32_t model);
  /// Give back those that were not asked for lately.
  void make_room();

  const std::size_t bytes_;
  std::mutex mutex_;
  Slots slots_;  // the one asked for last comes first
  std::unordered_map<std::uint32_t, Slots::iterator> of_model_;
  std::size_t taken_ = 0;
};

}  // namespace trivet::engine
