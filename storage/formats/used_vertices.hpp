/// Vertices of a mesh that lie on its surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// The vertices of triangles with nonzero area. Other vertices remain where an editor deleted
/// faces, or belong to triangles that degenerate to a line or a point: no surface is there.
struct UsedVertices {
  std::vector<std::uint8_t> marks;  ///< one per vertex: 1 if it is used
  std::size_t num_unused = 0;
  std::size_t num_without_area = 0;  ///< triangles that use an unused vertex
};

/// A triangle counts as degenerate if its height is below a millionth of its longest side, the
/// resolution of floats.
UsedVertices find_used_vertices(PointsView vertices, TrianglesView triangles);

}  // namespace trivet
