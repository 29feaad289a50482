/// Subsampling by removing local maxima of height.
#pragma once

#include <cstdint>

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Remove each point that is the highest in the vertical cylinder around it.
///
/// points   n positions; those with a non-finite coordinate are omitted
/// radius   radius of the cylinder, > 0, unit of the points; measured in the xy plane
/// indices  the points kept, ascending. A point alone in its cylinder is kept. Of equally high
///          points, the one of lowest index counts as the highest
/// A permutation of the points keeps the same ones, up to ties. Cost: O(n) cylinders.
/// Source: the local maximum filter of PCL, as described in the thesis (section 3.1.4).
void subsample_local_maximum(PointsView points, float radius, Column<std::uint32_t>& indices,
                             SubsampleScratch& scratch);

}  // namespace trivet::kernels
