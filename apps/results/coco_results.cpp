#include "apps/results/coco_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "engine/evaluation/object_view.hpp"
#include "storage/datasets/bop.hpp"

namespace trivet::apps {
namespace {

/// Reads the depth image in the library's unit. Errors: of reading, usage (not a depth image).
Result<engine::MeasuredImage> read_image(const SceneInput& source) {
  std::optional<Camera> camera = source.camera;
  if (camera) camera->depth_scale *= source.scale;
  Result<std::optional<engine::MeasuredImage>> image =
      engine::read_measured_image(source.file, camera);
  if (!image) return image.error();
  if (*image) return std::move(**image);
  return Error{ErrorCode::usage,
               fmt::format("--coco: expected depth images, found {}", source.file.string())};
}

}  // namespace

Result<void> add_coco_results(const SceneInputs& scenes, std::size_t index,
                              const Recognizer& recognizer, const SceneResult& found,
                              std::vector<CocoResult>& results) {
  const SceneInput& source = scenes.sources[index];
  const Result<engine::MeasuredImage> image = read_image(source);
  if (!image) return image.error();
  const Library& library = recognizer.library();
  const double delta = kBopDeltaMm * unit_scale(LengthUnit::millimeter, library.header.unit);
  for (const Detection& detection : found.detections) {
    const auto model = std::ranges::find(library.models, detection.model, &Model::name);
    const auto m = static_cast<std::uint32_t>(model - library.models.begin());
    const auto surface = recognizer.surface(m);
    if (!surface) return surface.error();
    Pose pose = detection.T_scene_model;
    pose.translation() *= static_cast<float>(source.scale);
    // No vertex is farther from the centroid than the diameter.
    const Result<engine::ObjectView> view = engine::view_object(
        {**surface, model->center.cast<double>(), static_cast<double>(model->diameter)}, pose,
        *image, delta);
    if (!view) return view.error();
    if (view->visible.num_pixels == 0) continue;
    results.push_back(
        {scenes.ids[index].scene, scenes.ids[index].image, scenes.object_ids.at(detection.model),
         static_cast<double>(detection.score), view->inside.rectangle(),
         encode_coco_mask(view->mask_visible, image->window.width), found.stats.total_seconds});
  }
  return {};
}

}  // namespace trivet::apps
