/// How sure detections are where nothing else was fitted.
#pragma once

#include "kernels/verification/pose_score.hpp"

namespace trivet {

/// Fitted on rendered scenes; engine/loaded_library/default_score.json holds its numbers and says
/// which.
const kernels::ScoreModel& default_score() noexcept;

}  // namespace trivet
