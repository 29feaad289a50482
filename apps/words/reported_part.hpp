/// Selection of the detections to report, among those kept for files that contain every pose.
#pragma once

#include "engine/options/recognize_options.hpp"
#include "engine/results/recognize_result.hpp"

namespace trivet::apps {

/// The result with the detections that reach options.min_score. Those between doubtful_score and
/// min_score join the rejected poses, up to max_rejected per model. Without doubtful_score, the
/// result is unchanged.
SceneResult reported_part(SceneResult result, const RecognizeOptions& options);

}  // namespace trivet::apps
