/// Meshes and pictures of the models of a library.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"
#include "storage/data/model.hpp"

namespace trivet::apps::service {

/// The rank of a model; absent: there is no such model.
std::optional<std::uint32_t> find_model(const Library& library, std::string_view name);

/// A model's surface as a PLY file, in the library's unit.
std::string model_mesh(const ModelSurface& surface);

/// Thumbnails, rendered on first use and kept as long as their generation answers. All members may
/// be called from any thread.
class Thumbnails {
 public:
  /// Returns a PNG. Pre: `model` belongs to the generation. Errors: internal, damaged.
  Result<std::string> png(const LibraryGeneration& generation, std::uint32_t model);

 private:
  std::mutex mutex_;
  std::uint64_t generation_ = 0;
  std::map<std::string, std::string> pictures_;
};

}  // namespace trivet::apps::service
