/// Subsampling to the lowest point of each vertical column.
#pragma once

#include <cstdint>

#include "kernels/surfaces/subsample_scratch.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Keep the point of lowest z in each square cell of the xy plane.
///
/// points   n positions; those with a non-finite coordinate are omitted
/// cell     edge of a square, > 0, unit of the points; squares have a corner at the origin
/// indices  one point per occupied square, ascending by (y, x) of the square; ties keep the lowest
///          index
/// A permutation of the points keeps the same ones, up to ties. Cost: O(n).
/// Source: the grid minimum filter of PCL, as described in the thesis (section 3.1.3).
void subsample_grid_minimum(PointsView points, float cell, Column<std::uint32_t>& indices,
                            SubsampleScratch& scratch);

}  // namespace trivet::kernels
