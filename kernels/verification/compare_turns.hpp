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

/// The turns to compare.
struct TurnRange {
  const Symmetry::Axis& axis;  ///< of the model
  /// Turns by multiples of it place the model alike [rad], > 0; 2 pi without symmetry.
  float period;
  float near;  ///< half the width of what counts as one turn [rad]
};

/// Compare the turns T_scene_model * turn_about(axis, angle) with T_scene_model by compare_poses, 4
/// degrees apart, and closer to the best one until half a degree.
///
/// The other arguments are those of compare_poses. Deterministic.
TurnComparison compare_turns(std::span<const RangeImage> images, const PosedModel& model,
                             const TurnRange& turns, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch);

}  // namespace trivet::kernels
