/// Detections in the images of a BOP data set as masks and boxes, as written by `trivet recognize
/// --coco`.
#pragma once

#include <cstddef>
#include <vector>

#include "apps/inputs/inputs.hpp"
#include "engine/loaded_library/recognizer.hpp"
#include "engine/recognition/recognize.hpp"
#include "storage/datasets/coco.hpp"

namespace trivet::apps {

/// Adds the detections of a scene. The model of each is rendered in its pose. As in BOP, the box
/// encloses the whole silhouette in the image, and the mask contains the part that the measured
/// depth leaves visible. A detection without a visible part is left out. Pre: check_bop_ids.
/// Errors: of reading the depth image; usage (not a depth image), internal (ray tracing).
Result<void> add_coco_results(const SceneInputs& scenes, std::size_t index,
                              const Recognizer& recognizer, const SceneResult& found,
                              std::vector<CocoResult>& results);

}  // namespace trivet::apps
