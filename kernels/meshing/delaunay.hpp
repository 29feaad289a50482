/// Delaunay tetrahedralization of points in space.
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
  /// Distinct positions, as indices of points: the lowest index of those at one position.
  Column<std::uint32_t> places;
  /// Tetrahedra that fill a box around the points. Corners are indices into `places`; the four from
  /// places.size() on are far outside.
  Column<Tetrahedron> tetrahedra;
  std::array<Eigen::Vector3d, 4> far_corners;  ///< positions of those four
};

/// Compute the Delaunay tetrahedra of points: no sphere through four corners contains a point.
///
/// points  n < 2^31 positions; non-finite ones are omitted. They are rounded to a lattice of 2^20
///         steps over their largest extent; points that coincide there are one place
/// Except for the indices, the result does not depend on the order of the points. All predicates
/// are exact, so grids, planes and spheres need no special care. Cost: n log n for scattered points
/// and surfaces, 200 bytes per point. Allocates.
/// Source: Bowyer and Watson, The Computer Journal 1981 (insertion); Amenta, Choi, Rote, SoCG 2003
/// (order of insertion: random rounds, each along a space-filling curve).
Delaunay find_delaunay(PointsView points);

}  // namespace trivet::kernels
