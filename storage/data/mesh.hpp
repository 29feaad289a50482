/// A triangle mesh.
#pragma once

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// Vertices and triangles.
struct Mesh {
  Points vertices;
  Triangles triangles;  ///< every index < vertices.size()
};

}  // namespace trivet
