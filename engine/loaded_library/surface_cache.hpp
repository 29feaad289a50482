/// Cache of the models' ray-tracing trees: built on demand, released when others need memory.
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

/// Thread-safe, also within TBB's tasks.
class SurfaceCache {
 public:
  using Surface = std::shared_ptr<const kernels::RayScene>;

  /// bytes  maximum memory of the trees; trees in use may exceed it
  explicit SurfaceCache(std::size_t bytes) : bytes_(bytes) {}

  /// The tree of a model, built by make() if necessary. Concurrent callers wait for one build.
  /// Errors: those of make.
  Result<Surface> get(std::uint32_t model, const std::function<Result<kernels::RayScene>()>& make);

 private:
  struct Slot;
  using Slots = std::list<std::shared_ptr<Slot>>;

  std::shared_ptr<Slot> slot_of(std::uint32_t model);
  /// Release the trees that were not requested lately.
  void make_room();

  const std::size_t bytes_;
  std::mutex mutex_;
  Slots slots_;  // the most recently requested one comes first
  std::unordered_map<std::uint32_t, Slots::iterator> of_model_;
  std::size_t used_bytes_ = 0;
};

}  // namespace trivet::engine
