/// BOP ground truth of an image beyond the objects' poses.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "engine/evaluation/object_view.hpp"
#include "engine/simulation/render_scenes.hpp"
#include "storage/datasets/bop.hpp"
#include "storage/datasets/coco.hpp"

namespace trivet::engine {

/// Computed from the models, the poses and the measured depth alone, so that anyone with the data
/// set can reproduce it. It uses the written values even where an object deviates from its model or
/// a camera is written incorrectly. Source: bop_toolkit, scripts/calc_gt_info.py, calc_gt_masks.py.
class BopTruth {
 public:
  /// models  object ids are their indices, starting at 1. Errors: bad_data, internal (ray tracing).
  static Result<BopTruth> create(std::span<const ScanModel> models);

  /// Set boxes, counts and the visible fraction of the image's instances, whose ids and poses must
  /// be set.
  ///
  /// depths  rows of `width` raw depths; multiplied by the image's depth_scale they are in mm
  /// Returns the view of each instance. As in the toolkit, boxes are x, y, and the differences of
  /// the last and first columns and rows; they are -1 for an instance without visible pixels.
  /// Thread-safe. Errors: internal (ray tracing).
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

/// The ground truth for scene_gt_coco.json. views: of the image's instances, from describe().
CocoImage coco_image(const BopImage& image, std::span<const ObjectView> views, std::uint32_t width,
                     std::uint32_t height);

}  // namespace trivet::engine
