/// Support of a keypoint: the surface around it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "kernels/common/voxel_hash.hpp"
#include "storage/common/columns.hpp"

namespace trivet::kernels {

/// Points within a radius of a keypoint, relative to it. The columns are padded to a multiple of
/// kLanes with points of no area at the keypoint.
struct Support {
  static constexpr std::size_t kLanes = 16;

  Column<float> x, y, z;  ///< position relative to the keypoint
  Column<float> area;     ///< area of the surface that each point represents, >= 0
  std::size_t size = 0;   ///< number of points without the padding
};

/// Gather the points of a grid within `radius` of a keypoint, in the grid's order.
///
/// areas    one per point of the cloud that the grid was built from; empty: area 1 each
/// support  grows once to the needed size; later calls allocate nothing
void gather_support(const VoxelHash& grid, std::span<const float> areas,
                    const Eigen::Vector3f& keypoint, float radius, Support& support);

/// Compute the area that each point represents under varying density: that of a disc, shared by the
/// points in the ball around it.
///
/// grid    grid of the points
/// points  n positions, in their order before the grid's; non-finite ones have no area
/// radius  > 0; some 2.5 times the distance of neighbors: a smaller one depends on chance
/// areas   n
/// Voxel grids hold more points where a surface is oblique to their axes. Without these weights,
/// moments of the surface would turn with the grid.
/// No allocation, lock or throw. Rows are independent: any split into chunks gives the same bits.
/// Source: inverse local density, Frome et al., ECCV 2004 (3-D shape contexts).
void share_areas(const VoxelHash& grid, PointsView points, float radius,
                 std::span<float> areas) noexcept;

}  // namespace trivet::kernels
