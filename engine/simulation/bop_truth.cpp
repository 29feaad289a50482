#include "engine/simulation/bop_truth.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <filesystem>

#include "engine/common/scaled.hpp"

namespace trivet::engine {
namespace {

std::array<int, 4> box_of(const PixelBox& pixels) {
  return {pixels.left, pixels.top, pixels.right - pixels.left, pixels.bottom - pixels.top};
}

}  // namespace

Result<BopTruth> BopTruth::create(std::span<const ScanModel> models) {
  BopTruth truth;
  for (const ScanModel& model : models) {
    const Points vertices = scaled_points(model.vertices, 1000);
    TRIVET_TRY_ASSIGN(kernels::RayScene surface,
                      kernels::RayScene::from_mesh(vertices, model.triangles));
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < vertices.size(); ++i) box.extend(vertices[i].cast<double>());
    truth.objects_.push_back({std::move(surface), box.center(), box.diagonal().norm() / 2});
  }
  return truth;
}

Result<std::vector<ObjectView>> BopTruth::describe(std::span<const std::uint16_t> depths,
                                                   std::uint32_t width, BopImage& image) const {
  const MeasuredImage measured = measured_image(depths, width, image.camera);
  std::vector<ObjectView> views;
  for (BopInstance& instance : image.instances) {
    const Object& object = objects_[static_cast<std::size_t>(instance.object_id) - 1];
    TRIVET_TRY_ASSIGN(ObjectView view, view_object({object.surface, object.center, object.radius},
                                                   instance.T_camera_model, measured, kBopDeltaMm));
    instance.px_count_all = view.all.num_pixels;
    instance.px_count_valid = view.num_valid;
    instance.px_count_visib = view.visible.num_pixels;
    if (view.all.num_pixels > 0) {
      instance.visib_fract = static_cast<double>(view.visible.num_pixels) / view.all.num_pixels;
    }
    if (view.visible.num_pixels > 0) {
      instance.bbox_obj = box_of(view.all);
      instance.bbox_visib = box_of(view.visible);
    }
    views.push_back(std::move(view));
  }
  return views;
}

CocoImage coco_image(const BopImage& image, std::span<const ObjectView> views, std::uint32_t width,
                     std::uint32_t height) {
  const std::filesystem::path depth = bop_depth_file({}, image.id);
  CocoImage out{image.id, depth.generic_string(), width, height, {}};
  for (std::size_t k = 0; k < views.size(); ++k) {
    const BopInstance& instance = image.instances[k];
    out.instances.push_back({instance.object_id, views[k].inside.rectangle(),
                             encode_coco_mask(views[k].mask_visible, width),
                             instance.visib_fract < kBopMinVisibleFraction});
  }
  return out;
}

}  // namespace trivet::engine
