/// The surface around a keypoint.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/common/columns.hpp"

namespace trivet::kernels {

/// Points within a radius of a keypoint, relative to it. The columns are longer than that: they are
/// filled with points of no area at the keypoint to a multiple of kLanes.
struct Support {
  static constexpr std::size_t kLanes = 16;

  Column<float> x, y, z;  ///< position less the keypoint's
  Column<float> area;     ///< of the surface that each point stands for, >= 0
  std::size_t size = 0;   ///< without the filling
};

/// Gather the points of a grid within `radius` of a keypoint, in the grid's order.
///
/// areas    one a point of the cloud that the grid was built from; empty: each point stands for 1
/// support  grows to what it needs once; later calls allocate nothing
void gather_support(const VoxelHash& grid, std::span<const float> areas,
                    const Eigen::Vector3f& keypoint, float radius, Support& support);

/// Write the area that each point stands for where points lie closer here and wider there: that of
/// a disc, shared by the points in the ball around it.
///
/// grid    of the points
/// points  n positions, in their order before the grid's; one that is not finite has no area
/// radius  > 0; some 2.5 times the distance of neighbors: a smaller one follows chance
/// areas   n
/// Grids of voxels hold more points where a surface stands across their axes; unless that is
/// weighed out, moments of the surface turn with the grid.
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
/// Source: inverse local density, Frome et al., ECCV 2004 (3-D shape contexts).
void share_areas(const VoxelHash& grid, PointsView points, float radius,
                 std::span<float> areas) noexcept;

}  // namespace trivet::kernels
