/// Detections in the images of a BOP data set as masks and boxes, as `trivet recognize --coco`
/// writes them.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/datasets/coco.hpp"

namespace trivet::apps {

/// Add the detections of a scene. Each is its model rendered in its pose: the box is of the whole
/// silhouette in the image, the mask of what is visible beside the measured depth, as BOP has it;
/// none is added of which nothing is.
/// Pre: check_bop_ids. Errors: of reading the depth image; usage (it is none), internal (ray tracing).
Result<void> add_coco_results(const SceneInputs& scenes, std::size_t index,
                              const Recognizer& recognizer, const SceneResult& found,
                              std::vector<CocoResult>& results);

}  // namespace trivet::apps
