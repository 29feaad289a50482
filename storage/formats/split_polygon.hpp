/// Triangulation of a polygon with any outline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/points.hpp"
#include "storage/formats/corner_grid.hpp"

namespace trivet::formats {

/// A triangle as three positions in a polygon's list of corners.
struct CornerTriangle {
  std::uint32_t a = 0, b = 0, c = 0;
};

/// Working memory of split_polygon, reused between polygons.
struct SplitScratch {
  struct Corner {
    double x = 0, y = 0;
    std::uint32_t previous = 0, next = 0;
    bool is_reflex = false, is_cut = false;
  };
  std::vector<Corner> corners;
  std::vector<std::uint32_t> waiting;
  CornerGrid grid;
};

/// Split a polygon into n - 2 triangles that cover the area enclosed by its outline.
///
/// points   points of the file; may be non-finite
/// corners  n >= 3 indices of points, in order along the outline. Corners may be collinear,
///          coincide and occur twice, and the outline may be slightly non-planar. Holes are part of
///          the outline by bridges: there over an edge, around the hole, and back over the same
///          edge
/// steps    limit on inspected corners and grid rows; reduced by the number used
/// out      n - 2 triangles, wound as the outline. If the fan around the first corner covers the
///          polygon, as for every convex one, it is the fan. The inside of a self-intersecting
///          outline is ambiguous: the result is the fan or that of ear clipping, whichever overlaps
///          less.
/// Returns whether the steps sufficed; if not, out is the fan. Corners are found by a grid:
/// O(n^1.5) steps for typical outlines of parts, O(n^2) in the worst case.
/// Source: Meisters, "Polygons Have Ears", American Mathematical Monthly 82 (1975).
bool split_polygon(PointsView points, std::span<const std::uint32_t> corners, SplitScratch& scratch,
                   std::uint64_t& steps, std::span<CornerTriangle> out);

}  // namespace trivet::formats
