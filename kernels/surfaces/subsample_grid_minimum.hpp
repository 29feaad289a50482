/// Subsample by columns of space: the lowest point of each.
#pragma once

#include <cstdint>

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Keep the point of lowest z in each square cell of the xy plane.
///
/// points   n positions; those with a non-finite coordinate are left out
/// cell     edge of a square, > 0, unit of the points; squares have a corner at the origin
/// indices  one point an occupied square, rising by (y, x) of the square; of equally low points the
///          one of lowest index
/// A permutation of the points keeps the same ones, up to ties. Cost: O(n).
/// Source: the grid minimum filter of PCL, as the thesis describes it (section 3.1.3).
void subsample_grid_minimum(PointsView points, float cell, Column<std::uint32_t>& indices,
                            SubsampleScratch& scratch);

}  // namespace trivet::kernels
