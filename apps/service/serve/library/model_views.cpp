#include "apps/service/serve/library/model_views.hpp"

#include <algorithm>

#include "engine/pictures/draw_model.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint32_t kWidth = 160;

}  // namespace

std::optional<std::uint32_t> find_model(const Library& library, std::string_view name) {
  const auto found = std::ranges::find(library.models, name, &ModelInfo::name);
  if (found == library.models.end()) return std::nullopt;
  return static_cast<std::uint32_t>(found - library.models.begin());
}

std::string model_mesh(const ModelSurface& surface) {
  Cloud cloud;
  cloud.points = Points(surface.vertices);
  cloud.triangles = Triangles(surface.triangles);
  return encode_ply(cloud);
}

Result<std::string> Thumbnails::png(const LibraryGeneration& generation, std::uint32_t model) {
  const Recognizer& recognizer = generation.recognizer;
  const std::string& name = recognizer.library().models[model].name;
  {
    const std::lock_guard lock(mutex_);
    if (generation.number == generation_) {
      if (const auto found = pictures_.find(name); found != pictures_.end()) return found->second;
    }
  }
  TRIVET_TRY_ASSIGN(const auto surface, recognizer.surface(model));
  TRIVET_TRY_ASSIGN(const ModelSurface* const mesh, recognizer.library().surface(model));
  const Result<std::vector<std::byte>> encoded =
      encode_png(draw_model(*surface, mesh->vertices, kWidth));
  if (!encoded) return encoded.error();
  std::string bytes(reinterpret_cast<const char*>(encoded->data()), encoded->size());
  const std::lock_guard lock(mutex_);
  if (generation.number > generation_) {
    generation_ = generation.number;
    pictures_.clear();
  }
  if (generation.number == generation_) pictures_[name] = bytes;
  return bytes;
}

}  // namespace trivet::apps::service
