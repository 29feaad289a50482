/// Surface reconstruction from an unorganized point cloud.
#pragma once

#include <cstdint>

#include "kernels/meshing/delaunay.hpp"
#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

struct TriangulateOptions {
  /// Radius of the largest ball that may roll over the surface without falling through, in local
  /// spacings, > 0; larger closes more holes and gaps. The spacing is the side of the square that
  /// each point covers alone.
  float max_radius = 2.5F;
  /// Triangles that continue the surface this flat, 0 to 180, precede all that fold more.
  float flat_angle_deg = 30;
  /// Largest angle by which a triangle may fold back over its neighbor, 0 to 180.
  float max_fold_angle_deg = 150;
  /// Largest angle between a triangle and the normals of its corners, 0 to 180: at edges these
  /// belong to either side.
  float max_normal_angle_deg = 90;
  /// Largest number of edges of holes to fill. Holes with a diagonal longer than twice `max_radius`
  /// stay open.
  std::uint32_t max_hole_edges = 20;
  bool operator==(const TriangulateOptions&) const = default;
};

/// Orient normals to the outside: the side from which a ball arrives that is too large for the gaps
/// between points.
///
/// points    n positions
/// delaunay  find_delaunay(points)
/// normals   n unit vectors, correct up to their sign; flipped in place, NaN if the ball reaches
///           both sides alike, as on an open sheet, or none, as inside
/// Errors: no_memory. Cost: n log n. Allocates.
/// Method: flood fill from far away by a ball of `max_radius` local spacings, through the faces of
/// the Delaunay tetrahedra (Edelsbrunner and Muecke, ACM TOG 1994), weighted by solid angles.
Result<void> orient_by_empty_space(PointsView points, const Delaunay& delaunay, float max_radius,
                                   NormalsSpan normals);

/// Reconstruct the surface from which points were sampled, randomly or regularly.
///
/// points    n positions; non-finite points and duplicates get no triangle
/// delaunay  find_delaunay(points)
/// normals   n outward unit vectors; NaN for unknown. They separate the sheets of a thin wall and
///           determine the winding
/// Returns triangles over the points, counter-clockwise seen from outside: every edge is in one of
/// them or in two, in opposite directions. Empty without a surface.
/// Errors: no_memory.
/// Except for the indices of the corners, the result does not depend on the order of the points.
/// Cost: n log n, some 500 bytes per point. Allocates.
///
/// Method: all triangles are faces of Delaunay tetrahedra. Starting from the smallest, the surface
/// grows over its boundary by the face with the smallest empty ball, flat ones first: Cohen-Steiner
/// and Da, The Visual Computer 2004. It differs in that triangles must agree with normals, and that
/// boundaries may touch for a while. Small holes are then filled with the least area: Barequet and
/// Sharir, CAGD 1995.
Result<Triangles> triangulate_cloud(PointsView points, const Delaunay& delaunay,
                                    NormalsView normals, const TriangulateOptions& options = {});

}  // namespace trivet::kernels
