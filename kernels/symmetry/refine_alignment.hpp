/// Refinement of the pose in which two similar surfaces coincide.
#pragma once

#include "kernels/surfaces/model_samples.hpp"
#include "storage/data/model.hpp"

namespace trivet::kernels {

/// A pose in which most of another surface lies on this one.
struct RefinedAlignment {
  Pose T_this_other = Pose::Identity();
  /// Share of the other surface's samples within the tolerance of this surface, facing the same
  /// way, 0..1.
  float agreeing = 0;
};

/// Refine a pose of another surface so that what both have in common coincides. What differs, such
/// as a hole, does not move the pose: samples farther than a gate have no weight, and the gate
/// shrinks from 6 % of the diameter to the tolerance.
///
/// surface, other  roughly uniform samples with unit normals; NaN normals are omitted
/// tolerance       distance of surfaces that coincide, in the samples' unit, > 0
/// start           T_this_other, within some 5 % of the diameter
/// Deterministic. Cost: 200 times the samples within the gate a step, eight steps, and O(samples).
/// Source: Chen and Medioni, IVC 1992 (distances from planes); Tukey's weights, Holland and Welsch,
/// Commun. Stat. 1977; the mean of both normals: Rusinkiewicz, SIGGRAPH 2019.
RefinedAlignment refine_alignment(const ModelSamples& surface, const ModelSamples& other,
                                  float tolerance, const Pose& start);

}  // namespace trivet::kernels
