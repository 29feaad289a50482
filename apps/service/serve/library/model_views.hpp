/// What people are shown of the models of a library.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "engine/recognition/recognition_service.hpp"
#include "storage/common/result.hpp"
#include "storage/data/model.hpp"

namespace trivet::apps::service {

const Model* find_model(const Library& library, std::string_view name);

/// The model's surface as the bytes of a PLY file, in the library's unit.
std::string model_mesh(const Model& model);

/// Small pictures, drawn when they are first asked for and kept as long as their generation
/// answers. Any member may be called from any thread.
class Thumbnails {
 public:
  /// PNG. Pre: `model` is one of the generation's. Errors: internal.
  Result<std::string> png(const LibraryGeneration& generation, const Model& model);

 private:
  std::mutex mutex_;
  std::uint64_t generation_ = 0;
  std::map<std::string, std::string> pictures_;
};

}  // namespace trivet::apps::service
