/// A surface of triangles through unorganized points with normals, open or closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Named as by Marton et al.; where a default is not theirs, triangulate_greedy says why.
struct GreedyOptions {
  std::uint32_t max_neighbors = 100;  ///< of a point, the nearest ones, >= 8
  /// Search radius, and so the longest edge, > 0 [unit of the points]. Infinite: `mu` alone counts.
  float radius = std::numeric_limits<float>::infinity();
  /// Longest edge in local spacings, >= 1 (the step of a square lattice, or 1.1 times the root of
  /// the area that each of random points has). Larger is slower and closes wider gaps: among random
  /// points 2.5 leaves 1 % of all edges open, 3 leaves 0.1 %.
  float mu = 3;
  /// Smallest angle of a triangle, 0 to 60: narrower ones are left out, and gaps stay in their
  /// place. Of random points one triangle in sixteen is below 10 degrees.
  float min_angle_deg = 0;
  /// Between two edges at the point whose fan is made, 60 to below 180: wider gaps stay open, as
  /// beyond the border of the surface.
  float max_angle_deg = 120;
  /// Between the normals of a triangle's corners, above 0 to 90; keeps the two sides of a thin wall
  /// apart, and leaves sharper edges open.
  float max_normal_angle_deg = 45;
  bool operator==(const GreedyOptions&) const = default;
};

/// Find the triangles of the surface that points were taken from.
///
/// points   n positions; those that are not finite, or where an earlier one is, get no triangle
/// normals  n directions, all to one side of the surface, of any length; points where one is zero
///          or not finite get no triangle
/// Returns triangles over the points, counter-clockwise seen from where the normals of their
/// corners point: every edge is in one of them or in two, in opposite directions.
/// Errors: no_memory. Takes memory. Cost: n log n.
/// Depends on the order of the points only in where the surface starts to grow.
///
/// Method: from point to point, along a growing front, the neighbors of a point are projected on
/// its tangent plane. What existing triangles hide from the point is left out, and the gaps of its
/// fan are closed over the others. Source: Marton, Rusu, Beetz, ICRA 2009, after Gopi and Krishnan,
/// SIBGRAPI 2002. Departs from them in four things: of the visible neighbors those are taken that
/// are the point's in the Delaunay triangulation of the plane (Gopi, Krishnan, Silva, Computer
/// Graphics Forum 19(3), 2000), so that the fans of neighbors agree and angles are as wide as they
/// can be; to leave the farther of two neighbors out that are less than 10 degrees apart, as the
/// paper does, then only makes other triangles narrow. Edges are measured at both ends, in spacings
/// found from eight neighbors, since the distance to the nearest one, which the paper multiplies
/// by mu (2.5 there), may be anything among random points. Neighbors lie within one spacing of the
/// tangent plane. A triangle must fit into the fans of all its corners, so that these never
/// overlap.
Result<Triangles> triangulate_greedy(PointsView points, NormalsView normals,
                                     const GreedyOptions& options = {});

}  // namespace trivet::kernels
