/// The occupied cells of a cubic lattice and the points in each.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "kernels/common/radix_sort.hpp"
#include "storage/common/columns.hpp"
#include "storage/data/points.hpp"

namespace trivet::kernels {

/// A cubic lattice with a corner at the origin, cut to the box of cells that a cloud occupies.
struct VoxelLattice {
  double cell = 1;                        ///< edge of a voxel, unit of the points
  double inverse_cell = 1;                ///< 1 / cell
  std::array<double, 3> lowest{};         ///< whole number: the lowest voxel of each axis
  std::array<double, 3> counts{1, 1, 1};  ///< whole number: voxels on each axis, >= 1

  /// Voxel of a coordinate on an axis, counted from the lowest: floor(value / cell) - lowest.
  /// Below 0 or past counts[axis] - 1 where the value lies outside the cloud's box.
  double coordinate(double value, int axis) const noexcept {
    return std::floor(value * inverse_cell) - lowest[static_cast<std::size_t>(axis)];
  }
  /// Whether every voxel has a number of its own in 64 bits, each axis counting in 32.
  bool fits_64_bits() const noexcept;
};

/// Find the lattice of a cloud. Points with a non-finite coordinate do not count.
/// Pre: cell > 0 and finite.
VoxelLattice fit_lattice(PointsView points, double cell);

/// Points grouped by voxel. Voxels rise by (z, y, x), the points of a voxel by index.
struct Voxels {
  Column<std::uint64_t> keys;     ///< one a voxel, rising; x + counts[0] * (y + counts[1] * z)
  Column<std::uint32_t> offsets;  ///< voxels + 1; voxel v holds order[offsets[v] .. offsets[v + 1])
  Column<std::uint32_t> order;    ///< indices of the points that are finite

  std::size_t size() const noexcept { return keys.size(); }
  std::span<const std::uint32_t> points_of(std::size_t voxel) const noexcept {
    return std::span(order).subspan(offsets[voxel], offsets[voxel + 1] - offsets[voxel]);
  }
};

/// Working memory of group_by_voxel.
struct VoxelScratch {
  Column<std::uint32_t> first, end;  ///< of each run of points in one voxel
  RadixScratch sort;
};

/// Group points by the voxels of a lattice.
///
/// points   n positions, n < 2^32; those with a non-finite coordinate are left out
/// lattice  fit_lattice(points, cell). Where it does not fit 64 bits, keys keep their order but not
///          their formula, and an axis of more than 2^32 voxels ends in one that takes all the rest
/// Cost: O(n), and for each 11 bits of the number of voxels in the box a counting pass over the
/// runs: consecutive points in one voxel, as an image has them, are sorted as one.
void group_by_voxel(PointsView points, const VoxelLattice& lattice, Voxels& out,
                    VoxelScratch& scratch);

}  // namespace trivet::kernels
