/// Why poses were rejected, and what lowers the scores of detections most, in the words of all
/// pages.
#pragma once

#include <string>

#include "engine/recognition/recognize.hpp"

namespace trivet::apps {

/// Plain text, such as "below 0.8", and "only 60 pixels agree; 83 % of its pixels are explained by
/// gear".
struct RejectionWords {
  std::string what, why;  ///< `why` may be empty

  std::string text() const { return why.empty() ? what : what + ": " + why; }
};

/// `rejected` belongs to the result, `options` are those of the recognition. If a detection
/// explains the pose, the words end with its model, so that a page may add its position on the
/// page.
RejectionWords rejection_words(const SceneResult& result, const RejectedPose& rejected,
                               const kernels::ScoreModel& score, const RecognizeOptions& options);

/// What lowers the score of a detection most: findings and other answers; empty if nothing lowers
/// it much.
std::string cost_words(const Detection& detection, const kernels::ScoreModel& score);

}  // namespace trivet::apps
