/// A surface of triangles through unorganized points.
#pragma once

#include <cstdint>

#include "kernels/meshing/delaunay.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct TriangulateOptions {
  /// Largest ball that may roll over the surface without falling through, in local spacings (the
  /// side of the square that a point has to itself), > 0; larger closes more holes and gaps.
  float max_radius = 2.5F;
  /// A triangle that goes on this flat, 0 to 180, comes before all that fold more.
  float flat_angle_deg = 30;
  /// How far a triangle may fold back over its neighbor, 0 to 180.
  float max_fold_angle_deg = 150;
  /// Between a triangle and the normals of its corners, 0 to 180: at edges these are of either
  /// side.
  float max_normal_angle_deg = 90;
  /// Holes of at most this many edges are filled, if none of their diagonals is longer than
  /// twice `max_radius`.
  std::uint32_t max_hole_edges = 20;
  bool operator==(const TriangulateOptions&) const = default;
};

/// Turn normals to the outside: to where a ball comes that is too large for the gaps between
/// points.
///
/// points    n positions
/// delaunay  find_delaunay(points)
/// normals   n unit vectors, correct up to their sign; turned in place, NaN where the ball comes to
///           both sides alike, as on an open sheet, or to none, as inside
/// Errors: no_memory. Cost: n log n. Takes memory.
/// Method: what a ball of `max_radius` local spacings reaches from far away, through the faces of
/// the Delaunay tetrahedra (Edelsbrunner and Muecke, ACM TOG 1994), weighted by solid angles.
Result<void> orient_by_empty_space(PointsView points, const Delaunay& delaunay, float max_radius,
                                   NormalsSpan normals);

/// Find the triangles of the surface that points were taken from, at random or regularly.
///
/// points    n positions; those that are not finite, or where another one is, get no triangle
/// delaunay  find_delaunay(points)
/// normals   n unit vectors to the outside; NaN for unknown. They keep the sheets of a thin wall
///           apart and give the winding
/// Returns triangles over the points, counter-clockwise seen from outside: every edge is in one of
/// them or in two, in opposite directions. Without a surface, none.
/// Errors: no_memory.
/// Nothing depends on the order of the points but the numbers of the corners. Cost: n log n, some
/// 500 bytes a point. Takes memory.
///
/// Method: all triangles are faces of Delaunay tetrahedra. From the smallest on, the surface grows
/// over its boundary by the face whose empty ball is smallest, flat ones first: Cohen-Steiner and
/// Da, The Visual Computer 2004; departs from it in that triangles must agree with normals, and
/// that boundaries may touch for a while. Small holes are then filled with the least area: Barequet
/// and Sharir, CAGD 1995.
Result<Triangles> triangulate_cloud(PointsView points, const Delaunay& delaunay,
                                    NormalsView normals, const TriangulateOptions& options = {});

}  // namespace trivet::kernels
