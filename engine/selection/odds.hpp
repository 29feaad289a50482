/// Odds of poses: scaled, and of one rather than another of its place.
#pragma once

#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {

/// The probability whose odds are `factor` times those of this one, which is below 1.
float scale_odds(float probability, float factor) noexcept;

/// Of a probability that counts as at least `least` and at most 1 - least.
double log_odds(float probability, double least) noexcept;

/// The logarithm of the odds that a pose is right and not the other one: by the pixels in which
/// they differ and by their scores, which see the others, too.
///
/// comparison  of the pose with the other
double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept;

}  // namespace trivet::engine
