/// Split a polygon into triangles, whatever its outline.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "storage/data/points.hpp"
#include "storage/formats/corner_grid.hpp"

namespace trivet::formats {

/// A triangle of three positions in the list of a polygon's corners.
struct CornerTriangle {
  std::uint32_t a = 0, b = 0, c = 0;
};

/// Memory of split_polygon, kept from one polygon to the next.
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

/// Split a polygon into n - 2 triangles that cover what its outline goes around.
///
/// points   of the file; may be non-finite
/// corners  n >= 3 indices of points, in order along the outline; corners may lie in line, coincide
///          and be named twice, the outline may be a little off its plane, and holes are part of it
///          by bridges: there over an edge, around the hole, and back over the same edge
/// steps    how many corners, and rows of the grid, may be looked at; what was needed is taken off
/// out      n - 2 triangles, wound as the outline. Where the fan around the first corner covers the
///          polygon, as of every convex one, it is the fan. An outline that crosses itself has no
///          one inside: of the fan and what ear clipping makes of it, the one with less overlap.
/// Returns whether the steps sufficed; if not, out is the fan. Corners are found by a grid: O(n^1.5)
/// steps for outlines as parts have them, O(n^2) for the worst.
/// Source: Meisters, "Polygons Have Ears", American Mathematical Monthly 82 (1975).
bool split_polygon(PointsView points, std::span<const std::uint32_t> corners, SplitScratch& scratch,
                   std::uint64_t& steps, std::span<CornerTriangle> out);

}  // namespace trivet::formats
