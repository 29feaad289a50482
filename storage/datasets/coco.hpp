/// Instance masks and bounding boxes in the COCO format of the BOP benchmark.
///
/// Results: a JSON list of {"scene_id", "image_id", "category_id", "score", "bbox": [x, y, width,
/// height], "segmentation": {"counts", "size": [height, width]}, "time"}. Ground truth:
/// scene_gt_coco.json in the folder of a scene, with the same fields for its instances. Source:
/// bop_toolkit, bop_toolkit_lib/inout.py, pycoco_utils.py, scripts/calc_gt_coco.py.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// A run-length encoded mask, column by column: alternating run lengths off, on, off, ...
struct CocoMask {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> counts;  ///< sum: width * height; the first may be 0
  std::uint32_t num_pixels = 0;       ///< number of pixels in the mask
};

/// pixels  rows of `width`; 0: off
CocoMask encode_coco_mask(std::span<const std::uint8_t> pixels, std::uint32_t width);

struct CocoResult {
  int scene_id = 0, image_id = 0, object_id = 0;
  double score = 0;
  std::array<int, 4> bbox{};  ///< x, y, width, height of the whole silhouette in the image [pixel]
  CocoMask mask;              ///< mask of the visible part
  double seconds = -1;        ///< time for the whole image; -1: unknown
};

/// Writes results in their order. The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_coco_results(const std::filesystem::path& file,
                                std::span<const CocoResult> results);

struct CocoInstance {
  int object_id = 0;
  std::array<int, 4> bbox{};
  CocoMask mask;        ///< mask of the visible part; instances without one are omitted
  bool ignore = false;  ///< the visible part is too small
};

struct CocoImage {
  int id = 0;
  std::string file;  ///< image file relative to the scene's folder
  std::uint32_t width = 0, height = 0;
  std::vector<CocoInstance> instances;
};

/// object_ids  ids of all objects of the data set
/// The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_coco_truth(const std::filesystem::path& file, std::span<const int> object_ids,
                              std::span<const CocoImage> images);

}  // namespace trivet
