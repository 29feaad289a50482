/// Find the turn about an axis that explains the scan best, of a model that looks alike under any.
#pragma once

#include <span>
#include <vector>

#include "kernels/verification/compare_poses.hpp"

namespace trivet::kernels {

/// Turns about an axis of the model, as the scan sees them.
struct TurnComparison {
  /// The mean of the turns that the scan cannot tell from the one that explains it best, weighted
  /// by their likelihoods [rad]: what errs least.
  float best = 0;
  /// These turns lie between, and explain the scan a tenth as well or better [rad]; apart by a
  /// whole period if all turns do.
  float low = 0, high = 0;
  float share = 1;            ///< of the likelihood of all turns, what lies near it, 0..1
  std::vector<float> others;  ///< turns not near it nor each other that explain the scan a tenth as
                              ///< well or better, likeliest first [rad]
};

/// Compare the turns T_scene_model * turn_about(axis, angle) with T_scene_model by compare_poses, 4
/// degrees apart, and closer to the best one until half a degree.
///
/// period  turns by multiples of it place the model alike [rad], > 0; 2 pi without symmetry
/// near    half the width of what counts as one turn [rad]
/// The other arguments are those of compare_poses. Deterministic.
TurnComparison compare_turns(std::span<const RangeImage> images, const RayScene& surface,
                             const ModelSamples& samples, const Pose& T_scene_model,
                             const Symmetry::Axis& axis, float period, float near,
                             const MeasurementErrors& errors, const VerifyOptions& options,
                             CompareScratch& scratch);

}  // namespace trivet::kernels
