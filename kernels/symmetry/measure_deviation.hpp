/// How far a motion takes a surface off itself.
#pragma once

#include <span>

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Write how far each sample, moved, lies from the surface: along the normals, plus what the way along
/// the surface exceeds `spacing` by. Only what faces the same way counts as the surface, within 60
/// degrees, unless nothing does.
///
/// samples, normals  n >= 1, about uniform over the surface; unit vectors
/// spacing           mean distance of neighboring samples, in their unit
/// out               n distances, in their unit
/// Pre: out.size() == samples.size(). No allocation. Each row is independent. Cost: n^2.
void measure_deviation(PointsView samples, NormalsView normals, float spacing, const Pose& motion,
                       std::span<float> out) noexcept;

}  // namespace trivet::kernels
