/// Odds of poses: scaling, and the odds of one hypothesis against another for the same place.
#pragma once

#include "kernels/verification/compare_poses.hpp"

namespace trivet::engine {

/// The probability whose odds are `factor` times those of `probability` < 1.
float scale_odds(float probability, float factor) noexcept;

/// The score of a pose beside answers at its place that its shape does not explain: poses of the
/// same model, or other shapes. They are typical of false detections: in the drawn scenes of
/// scripts/calibrate, an unexplained alternative pose accompanies 39 of 670 correct and 48 of 143
/// wrong detections with scores from 0.8.
///
/// share  probability of these answers, if anything is there, 0..1
float score_beside_strange(float score, float share) noexcept;

/// Log odds that a pose is correct rather than the other one, by the pixels where they differ and
/// by their scores, which also include the other pixels.
///
/// comparison  comparison of the pose with the other one
double rival_log_odds(float score, float other_score,
                      const kernels::PoseComparison& comparison) noexcept;

}  // namespace trivet::engine
