/// Subsample by removing the points that stand out upwards.
#pragma once

#include <cstdint>

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Remove each point that is the highest in the vertical cylinder around it.
///
/// points   n positions; those with a non-finite coordinate are left out
/// radius   of the cylinder, > 0, unit of the points; distances are taken in the xy plane
/// indices  the points kept, rising. A point alone in its cylinder is kept. Of equally high points
///          the one of lowest index counts as the highest
/// A permutation of the points keeps the same ones, up to ties. Cost: O(n) cylinders.
/// Source: the local maximum filter of PCL, as the thesis describes it (section 3.1.4).
void subsample_local_maximum(PointsView points, float radius, Column<std::uint32_t>& indices,
                             SubsampleScratch& scratch);

}  // namespace trivet::kernels
