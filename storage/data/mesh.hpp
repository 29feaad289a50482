/// A surface of triangles, as one thing to hand around.
#pragma once

#include "storage/data/cloud.hpp"
#include "storage/data/points.hpp"

namespace trivet {

/// Vertices, and triangles between them.
struct Mesh {
  Points vertices;
  Triangles triangles;  ///< every index < vertices.size()
};

}  // namespace trivet
