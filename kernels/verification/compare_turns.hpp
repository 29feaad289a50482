/// Search for the rotation about an axis that explains the scan best, for a model that looks alike
/// under any such rotation.
#pragma once

#include <span>
#include <vector>

#include "kernels/verification/compare_poses.hpp"

namespace trivet::kernels {

/// Rotations about an axis of the model, compared with the scan.
struct TurnComparison {
  /// Mean of the rotations that the scan cannot distinguish from the one that explains it best,
  /// weighted by their likelihoods [rad]: the estimate with the least error.
  float best = 0;
  /// Range of these rotations, which explain the scan a tenth as well or better [rad]; a whole
  /// period apart if all rotations do.
  float low = 0, high = 0;
  float share = 1;            ///< share of the total likelihood near the best rotation, 0..1
  std::vector<float> others;  ///< rotations not near it nor each other that explain the scan a
                              ///< tenth as well or better, likeliest first [rad]
};

/// Rotations to compare.
struct TurnRange {
  const Symmetry::Axis& axis;  ///< axis of the model
  /// Rotations by multiples of it place the model alike [rad], > 0; 2 pi without symmetry.
  float period;
  float near;  ///< half-width within which rotations count as one [rad]
};

/// Compare the rotations T_scene_model * turn_about(axis, angle) with T_scene_model by
/// compare_poses, at steps of 4 degrees, refined around the best one to half a degree.
///
/// The other arguments are those of compare_poses. Deterministic.
TurnComparison compare_turns(std::span<const RangeImage> images, const PosedModel& model,
                             const TurnRange& turns, const MeasurementErrors& errors,
                             const VerifyOptions& options, CompareScratch& scratch);

}  // namespace trivet::kernels
