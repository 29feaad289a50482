/// Of detections that were kept for files that take every pose, those that a person is told.
#pragma once

#include "engine/options/recognize_options.hpp"
#include "engine/results/recognize_result.hpp"

namespace trivet::apps {

/// The result with the detections that reach options.min_score. Those between doubtful_score and it
/// join the rejected poses, up to max_rejected of a model. Without doubtful_score: the same.
SceneResult reported_part(SceneResult result, const RecognizeOptions& options);

}  // namespace trivet::apps
