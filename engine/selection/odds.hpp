/// Odds of poses: scaling, and the odds of one hypothesis against another for the same place.
#pragma once

#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {

/// Factor on the odds of a pose with an equally good answer at its place that its shape does not
/// explain: a pose of the same model, or another shape. This is typical of false detections: in the
/// drawn scenes of scripts/calibrate, an unexplained alternative pose accompanies 39 of 670 correct
/// and 48 of 143 wrong detections with scores from 0.8.
inline constexpr float kOddsOfStrangeAnswer = 0.4F;

/// The probability whose odds are `factor` times those of `probability` < 1.
float scale_odds(float probability, float factor) noexcept;

/// Log odds that a pose is correct rather than the other one, by the pixels where they differ and
/// by their scores, which also include the other pixels.
///
/// comparison  comparison of the pose with the other one
double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept;

}  // namespace trivet::engine
