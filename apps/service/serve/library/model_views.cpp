#include "apps/service/serve/library/model_views.hpp"

#include <algorithm>

#include "engine/pictures/draw_model.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::apps::service {
namespace {

constexpr std::uint32_t kWidth = 160;

}  // namespace

const Model* find_model(const Library& library, std::string_view name) {
  const auto found = std::ranges::find(library.models, name, &Model::name);
  return found == library.models.end() ? nullptr : &*found;
}

std::string model_mesh(const Model& model) {
  Cloud cloud;
  cloud.points = Points(model.vertices);
  cloud.triangles = Triangles(model.triangles);
  return encode_ply(cloud);
}

Result<std::string> Thumbnails::png(const LibraryGeneration& generation, const Model& model) {
  {
    const std::lock_guard lock(mutex_);
    if (generation.number == generation_) {
      if (const auto found = pictures_.find(model.name); found != pictures_.end())
        return found->second;
    }
  }
  const auto index =
      static_cast<std::uint32_t>(&model - generation.recognizer.library().models.data());
  const auto surface = generation.recognizer.surface(index);
  if (!surface) return surface.error();
  const Result<std::vector<std::byte>> encoded =
      encode_png(draw_model(**surface, model.vertices, kWidth));
  if (!encoded) return encoded.error();
  std::string bytes(reinterpret_cast<const char*>(encoded->data()), encoded->size());
  const std::lock_guard lock(mutex_);
  if (generation.number > generation_) {
    generation_ = generation.number;
    pictures_.clear();
  }
  if (generation.number == generation_) pictures_[model.name] = bytes;
  return bytes;
}

}  // namespace trivet::apps::service
