/// Which side of a densely sampled surface is outside, as sparser samples know it.
#pragma once

#include <span>

#include "storage/data/model.hpp"
#include "storage/data/points.hpp"

namespace trivet::engine {

/// Turn the normals of dense points to the outward side of the nearest sample of the same sheet.
///
/// samples  positions with outward normals, `spacing` apart
/// views    of the samples, one each, or empty: points nearer to a sample that no view sees lose
///          their normal, which becomes NaN; so do points far from all samples
void orient_by_samples(PointsView samples, NormalsView sample_normals,
                       std::span<const ViewMask> views, float spacing, PointsView points,
                       NormalsSpan normals);

/// Set the normals of points to NaN where the nearest sample that looks the same way is one that nothing
/// sees, or no sample is near. The normals look outwards, as those of the samples do.
void hide_by_samples(PointsView samples, NormalsView sample_normals,
                     std::span<const ViewMask> views, float spacing, PointsView points,
                     NormalsSpan normals);

}  // namespace trivet::engine
