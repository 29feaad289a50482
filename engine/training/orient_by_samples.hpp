/// Outward direction of a densely sampled surface, from sparser samples.
#pragma once

#include <span>

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Orient the normals of dense points to the outward side of the nearest sample of the same sheet.
///
/// samples  positions with outward normals, `spacing` apart
/// views    views of each sample, or empty. The normals of points near a sample that is visible
///          in no view become NaN, and so do those of points far from all samples
void orient_by_samples(PointsView samples, NormalsView sample_normals,
                       std::span<const ViewMask> views, float spacing, PointsView points,
                       NormalsSpan normals);

/// Set the normals of points to NaN if the nearest sample with a similar normal is visible in no
/// view, or if no sample is near. The normals point outward, like those of the samples.
void hide_by_samples(PointsView samples, NormalsView sample_normals,
                     std::span<const ViewMask> views, float spacing, PointsView points,
                     NormalsSpan normals);

}  // namespace trivet::engine
