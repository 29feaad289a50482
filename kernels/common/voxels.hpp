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

/// A cubic lattice with a corner at the origin, restricted to the bounding box of a cloud.
struct VoxelLattice {
  double cell = 1;                        ///< edge of a voxel, unit of the points
  double inverse_cell = 1;                ///< 1 / cell
  std::array<double, 3> lowest{};         ///< whole number: lowest voxel index along each axis
  std::array<double, 3> counts{1, 1, 1};  ///< whole number: voxels along each axis, >= 1

  /// Voxel index of a coordinate along an axis, relative to the lowest: floor(value / cell) -
  /// lowest. Negative or past counts[axis] - 1 if the value lies outside the cloud's box.
  double coordinate(double value, int axis) const noexcept {
    return std::floor(value * inverse_cell) - lowest[static_cast<std::size_t>(axis)];
  }
  /// Whether every voxel has a unique 64-bit key, with 32 bits per axis.
  bool fits_64_bits() const noexcept;
};

/// Find the lattice of a cloud. Points with a non-finite coordinate are ignored.
/// Pre: cell > 0 and finite.
VoxelLattice fit_lattice(PointsView points, double cell);

/// Points grouped by voxel. Voxels ascend by (z, y, x), the points of a voxel by index.
struct Voxels {
  Column<std::uint64_t> keys;     ///< one per voxel, ascending; x + counts[0] * (y + counts[1] * z)
  Column<std::uint32_t> offsets;  ///< voxels + 1; voxel v holds order[offsets[v] .. offsets[v + 1])
  Column<std::uint32_t> order;    ///< indices of the finite points

  std::size_t size() const noexcept { return keys.size(); }
  std::span<const std::uint32_t> points_of(std::size_t voxel) const noexcept {
    return std::span(order).subspan(offsets[voxel], offsets[voxel + 1] - offsets[voxel]);
  }
};

/// Working memory of group_by_voxel.
struct VoxelScratch {
  Column<std::uint32_t> first, end;  ///< bounds of each run of points in one voxel
  RadixScratch sort;
};

/// Group points by the voxels of a lattice.
///
/// points   n positions, n < 2^32; those with a non-finite coordinate are omitted
/// lattice  fit_lattice(points, cell). If it does not fit 64 bits, keys keep their order but not
///          their formula, and an axis of more than 2^32 voxels ends in one voxel for all the rest
/// Cost: O(n), plus one counting pass over the runs for each 11 bits of the number of voxels in the
/// box. A run is consecutive points in one voxel, as in an image, and is sorted as one item.
void group_by_voxel(PointsView points, const VoxelLattice& lattice, Voxels& out,
                    VoxelScratch& scratch);

}  // namespace trivet::kernels
