/// Which vertices of a mesh lie on its surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// The vertices that some triangle with an area uses. Others are what editors leave behind where
/// faces were deleted, or belong to triangles that are a line or a point: no surface is there.
struct UsedVertices {
  std::vector<std::uint8_t> marks;  ///< one a vertex: 1 if it is used
  std::size_t num_unused = 0;
  std::size_t num_without_area = 0;  ///< triangles that use an unused vertex
};

/// A triangle has no area where its height is less than floats tell beside its longest side, a
/// millionth of that.
UsedVertices find_used_vertices(PointsView vertices, TrianglesView triangles);

}  // namespace trivet
