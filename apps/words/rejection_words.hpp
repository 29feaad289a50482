/// Why poses were rejected, and what costs those most that were found, in the words of all pages.
#pragma once

#include <string>

#include "engine/recognition/recognize.hpp"

namespace trivet::apps {

/// Plain text: "below 0.8", and "only 60 pixels agree; 83 % of its pixels are explained by gear".
struct RejectionWords {
  std::string what, why;  ///< `why` may be empty

  std::string text() const { return why.empty() ? what : what + ": " + why; }
};

/// `rejected` is one of the result's, `options` those that it was recognized with. Where a detection
/// explains the pose, the words end with its model: a page may add its place on the page.
RejectionWords rejection_words(const SceneResult& result, const RejectedPose& rejected,
                               const kernels::ScoreModel& score, const RecognizeOptions& options);

/// What costs a detection most: findings and other answers; empty where nothing costs much.
std::string cost_words(const Detection& detection, const kernels::ScoreModel& score);

}  // namespace trivet::apps
