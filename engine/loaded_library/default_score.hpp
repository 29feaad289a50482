/// Default score of detections, used if no other score was fitted.
#pragma once

#include "kernels/scoring/pose_score.hpp"

namespace trivet {

/// The score fitted on rendered scenes. engine/loaded_library/default_score.json contains its
/// numbers and lists the scenes.
const kernels::ScoreModel& default_score() noexcept;

}  // namespace trivet
