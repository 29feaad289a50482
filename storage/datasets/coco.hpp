/// Masks and boxes of objects in images, in the form of COCO as the BOP benchmark takes it.
///
/// Results: a JSON list of {"scene_id", "image_id", "category_id", "score", "bbox": [x, y, width,
/// height], "segmentation": {"counts", "size": [height, width]}, "time"}. Truth: scene_gt_coco.json
/// in the folder of a scene, which has the same of its instances. Source: bop_toolkit,
/// bop_toolkit_lib/inout.py, pycoco_utils.py, scripts/calc_gt_coco.py.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "storage/common/result.hpp"

namespace trivet {

/// A mask as lengths of runs, column after column, which take turns: off, on, off, ...
struct CocoMask {
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint32_t> counts;  ///< sum: width * height; the first may be 0
  std::uint32_t num_pixels = 0;       ///< that are on
};

/// pixels  rows of `width`; 0: off
CocoMask encode_coco_mask(std::span<const std::uint8_t> pixels, std::uint32_t width);

struct CocoResult {
  int scene_id = 0, image_id = 0, object_id = 0;
  double score = 0;
  std::array<int, 4> bbox{};  ///< x, y, width, height of the whole silhouette in the image [pixel]
  CocoMask mask;              ///< of what is visible
  double seconds = -1;        ///< for the whole image; -1: unknown
};

/// In their order. The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_coco_results(const std::filesystem::path& file,
                                std::span<const CocoResult> results);

struct CocoInstance {
  int object_id = 0;
  std::array<int, 4> bbox{};
  CocoMask mask;        ///< of what is visible; instances without are left out
  bool ignore = false;  ///< too little is visible
};

struct CocoImage {
  int id = 0;
  std::string file;  ///< relative to the scene's folder
  std::uint32_t width = 0, height = 0;
  std::vector<CocoInstance> instances;
};

/// object_ids  of the whole data set
/// The file appears whole or not at all. Errors: cannot_create, io.
Result<void> write_coco_truth(const std::filesystem::path& file, std::span<const int> object_ids,
                              std::span<const CocoImage> images);

}  // namespace trivet
