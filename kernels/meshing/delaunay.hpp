/// Delaunay tetrahedra of points in space.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// Four corners, positively oriented: det(c1 - c0, c2 - c0, c3 - c0) > 0. `across[k]` is the
/// tetrahedron that shares the face opposite corner k; kNone beyond the outermost ones.
struct Tetrahedron {
  static constexpr std::uint32_t kNone = 0xFFFF'FFFFU;
  std::array<std::uint32_t, 4> corner, across;
};

struct Delaunay {
  /// Distinct places, as indices of points: the lowest of those that fall into one place.
  Column<std::uint32_t> places;
  /// Fill a box around the points. Corners are indices into `places`; the four from places.size()
  /// on are far outside.
  Column<Tetrahedron> tetrahedra;
  std::array<Eigen::Vector3d, 4> far_corners;  ///< where those four are
};

/// Find the Delaunay tetrahedra of points: no ball through four corners holds a place.
///
/// points  n < 2^31 positions; those that are not finite are left out. They are rounded to a
///         lattice of 2^20 steps over their largest extent: what coincides there is one place
/// Nothing depends on the order of the points but the indices; all predicates are exact, so that
/// grids, planes and spheres need no care. Cost: n log n for scattered points and surfaces, 200
/// bytes a point. Takes memory.
/// Source: Bowyer and Watson, The Computer Journal 1981 (insertion); Amenta, Choi, Rote, SoCG 2003
/// (order of insertion: random rounds, each along a space-filling curve).
Delaunay find_delaunay(PointsView points);

}  // namespace trivet::kernels
