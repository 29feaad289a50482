/// What a BOP data set tells of the objects in an image beside their poses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/evaluation/object_view.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "storage/datasets/bop.hpp"
#include "storage/datasets/coco.hpp"

namespace trivet::engine {

/// From the models, the poses and the measured depth alone, as anyone who has the data set can find
/// it again: by what is written, not by what is true where an object deviates from its model or a
/// camera is written wrong. Source: bop_toolkit, scripts/calc_gt_info.py, calc_gt_masks.py.
class BopTruth {
 public:
  /// models  object ids count them from 1. Errors: bad_data, internal (ray tracing).
  static Result<BopTruth> create(std::span<const ScanModel> models);

  /// Fill in boxes, counts and the visible fraction of the image's instances, whose ids and poses
  /// are there.
  ///
  /// depths  rows of `width` raw depths; times the image's depth_scale mm
  /// Returns what is seen of each instance. Boxes are x, y, and the last column and row less the
  /// first, as the toolkit has them; -1s of an instance without any visible pixel.
  /// Any number of threads may call it at the same time. Errors: internal (ray tracing).
  Result<std::vector<ObjectView>> describe(std::span<const std::uint16_t> depths,
                                           std::uint32_t width, BopImage& image) const;

 private:
  struct Object {
    kernels::RayScene surface;
    Eigen::Vector3d center;  // [mm]
    double radius;
  };
  std::vector<Object> objects_;
};

/// The same for scene_gt_coco.json. views: of the image's instances, described.
CocoImage coco_image(const BopImage& image, std::span<const ObjectView> views, std::uint32_t width,
                     std::uint32_t height);

}  // namespace trivet::engine
