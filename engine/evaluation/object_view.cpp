#include "engine/evaluation/object_view.hpp"

#include "kernels/scans/pixel_window.hpp"
#include "kernels/scans/render_depth.hpp"
#include "storage/formats/read_cloud.hpp"

namespace trivet::engine {

using kernels::PixelWindow;
using kernels::RayScene;

Result<std::optional<MeasuredImage>> read_measured_image(const std::filesystem::path& file,
                                                         const std::optional<Camera>& camera) {
  if (!camera || !is_depth_file(file)) return std::optional<MeasuredImage>();
  TRIVET_TRY_ASSIGN(const Cloud cloud, read_cloud(file, {.camera = camera}));
  if (!cloud.camera || !cloud.grid) return std::optional<MeasuredImage>();
  const PixelGrid& grid = *cloud.grid;
  MeasuredImage image{
      *cloud.camera, {0, 0, grid.width, grid.height}, std::vector<float>(grid.point_index.size())};
  for (std::size_t i = 0; i < image.distance.size(); ++i) {
    if (grid.point_index[i] == PixelGrid::kNone) continue;
    image.distance[i] = cloud.points[static_cast<std::size_t>(grid.point_index[i])].norm();
  }
  return std::optional(std::move(image));
}

MeasuredImage measured_image(std::span<const std::uint16_t> depths, std::uint32_t width,
                             const Camera& camera) {
  const auto height = static_cast<std::uint32_t>(depths.size() / width);
  MeasuredImage image{camera, {0, 0, width, height}, std::vector<float>(depths.size())};
  const auto scale = static_cast<float>(camera.depth_scale);
  for (std::size_t i = 0; i < depths.size(); ++i)
    image.distance[i] = static_cast<float>(depths[i]) * scale;
  kernels::depths_to_distances(camera, width, image.distance);
  return image;
}

Result<ObjectImage> render_object(const RayScene& surface, const Pose& T_camera_object,
                                  const Camera& camera, const PixelWindow& window) {
  ObjectImage image{window, std::vector<float>(window.size())};
  if (window.empty()) return image;
  const RayScene::Instance instance{&surface, T_camera_object};
  TRIVET_TRY_ASSIGN(const RayScene posed, RayScene::from_instances({&instance, 1}));
  const Camera own = kernels::camera_of_window(camera, window);
  std::vector<std::uint32_t> instances(window.size());
  kernels::render_depth(posed, own, window.width, 0, {image.distance, instances});
  kernels::depths_to_distances(own, window.width, image.distance);
  return image;
}

Result<ObjectView> view_object(const ObjectShape& object, const Pose& T_camera_object,
                               const MeasuredImage& image, double delta) {
  const std::uint32_t width = image.window.width, height = image.window.height;
  Camera canvas = image.camera;  // area of three by three images with this one in the middle
  canvas.cx += width;
  canvas.cy += height;
  const PixelWindow window = kernels::window_of_ball(
      canvas, 3 * width, 3 * height, T_camera_object.cast<double>() * object.center, object.radius);
  TRIVET_TRY_ASSIGN(const ObjectImage rendered,
                    render_object(object.surface, T_camera_object, canvas, window));

  ObjectView view;
  view.mask.assign(image.distance.size(), 0);
  view.mask_visible = view.mask;
  for (std::size_t i = 0; i < rendered.distance.size(); ++i) {
    const float distance = rendered.distance[i];
    if (!(distance > 0)) continue;
    const auto u = static_cast<int>(window.left + i % window.width) - static_cast<int>(width),
               v = static_cast<int>(window.top + i / window.width) - static_cast<int>(height);
    view.all.add(u, v);
    if (u < 0 || v < 0 || u >= static_cast<int>(width) || v >= static_cast<int>(height)) continue;
    const std::size_t pixel = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
    const float measured = image.distance[pixel];
    view.inside.add(u, v);
    view.mask[pixel] = 255;
    view.num_valid += measured > 0 ? 1 : 0;
    if (!kernels::is_visible(distance, measured, delta)) continue;
    view.visible.add(u, v);
    view.mask_visible[pixel] = 255;
  }
  return view;
}

}  // namespace trivet::engine
