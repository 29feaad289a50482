/// Surface reconstruction from an unorganized point cloud with normals, open or closed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Named as by Marton et al.; triangulate_greedy gives the reasons for other defaults.
struct GreedyOptions {
  std::uint32_t max_neighbors = 100;  ///< neighbors considered per point, the nearest ones, >= 8
  /// Search radius, and so the longest edge, > 0 [unit of the points]. Infinite: only `mu` limits.
  float radius = std::numeric_limits<float>::infinity();
  /// Longest edge in local spacings, >= 1. The spacing is the step of a square lattice, or for
  /// random points 1.1 times the square root of the area per point. Larger is slower and closes
  /// wider gaps: among random points 2.5 leaves 1 % of all edges open, 3 leaves 0.1 %.
  float mu = 3;
  /// Smallest angle of a triangle, 0 to 60: narrower ones are omitted and leave gaps. Of random
  /// points one triangle in sixteen is below 10 degrees.
  float min_angle_deg = 0;
  /// Largest angle between two edges at the center of a fan, 60 to below 180: wider gaps stay open,
  /// as beyond the border of the surface.
  float max_angle_deg = 120;
  /// Largest angle between the normals of a triangle's corners, above 0 to 90; separates the two
  /// sides of a thin wall, and leaves sharper edges open.
  float max_normal_angle_deg = 45;
  bool operator==(const GreedyOptions&) const = default;
};

/// Reconstruct the surface from which points were sampled.
///
/// points   n positions; non-finite points and duplicates of earlier ones get no triangle
/// normals  n directions, all to one side of the surface, of any length; points with a zero or
///          non-finite one get no triangle
/// Returns triangles over the points, counter-clockwise seen from the side of their corners'
/// normals: every edge is in one of them or in two, in opposite directions.
/// Errors: no_memory. Allocates. Cost: n log n.
/// The order of the points affects only where the surface starts to grow.
///
/// Method: along a growing front, the neighbors of a point are projected onto its tangent plane.
/// Neighbors hidden from the point by existing triangles are omitted, and the gaps of its fan are
/// closed with the others. Source: Marton, Rusu, Beetz, ICRA 2009, after Gopi and Krishnan,
/// SIBGRAPI 2002. It differs in four things. (1) Of the visible neighbors, only the point's
/// neighbors in the Delaunay triangulation of the plane are chosen (Gopi, Krishnan, Silva, Computer
/// Graphics Forum 19(3), 2000), so that the fans of neighbors agree and angles are as wide as they
/// can be. The paper omits the farther of two neighbors less than 10 degrees apart; here that would
/// only make other triangles narrow. (2) Edges are measured at both ends, in spacings found from
/// eight neighbors. The paper multiplies the distance to the nearest neighbor by mu (2.5 there),
/// but among random points that distance may be anything. (3) Neighbors lie within one spacing of
/// the tangent plane. (4) A triangle must fit into the fans of all its corners, so that these never
/// overlap.
Result<Triangles> triangulate_greedy(PointsView points, NormalsView normals,
                                     const GreedyOptions& options = {});

}  // namespace trivet::kernels
