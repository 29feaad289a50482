/// Deviation of a transformed surface from itself.
#pragma once

#include <span>

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Compute the distance of each transformed sample from the surface: along the normals, plus the
/// part of the distance along the surface that exceeds `spacing`. Only samples that face the same
/// way, within 60 degrees, count as the surface, unless there are none.
///
/// samples, normals  n >= 1, roughly uniform over the surface; unit vectors
/// spacing           mean distance of neighboring samples, in their unit
/// out               n distances, in their unit
/// Pre: out.size() == samples.size(). No allocation. Each row is independent. Cost: n^2.
void measure_deviation(PointsView samples, NormalsView normals, float spacing, const Pose& motion,
                       std::span<float> out) noexcept;

}  // namespace trivet::kernels
