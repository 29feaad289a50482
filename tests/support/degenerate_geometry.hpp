/// Meshes that are hardly a surface, or that contain the same surface many times.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "storage/data/cloud.hpp"

namespace trivet::test {

struct DegenerateMesh {
  std::string name;  ///< its defect, and its number of vertices
  Cloud cloud;       ///< every edge is between triangles, as in a closed surface
};

/// Meshes of 1 to 12 vertices: all at one point, in a line, in a plane, at two points, scattered,
/// too close together for floats to distinguish, denormal, huge, and far from the origin.
std::vector<DegenerateMesh> degenerate_meshes();

/// A tetrahedron some 200 across whose faces occur `layers` times.
Cloud layered_tetrahedron(std::size_t layers);

/// The same with separate, slightly shifted vertices for each layer.
Cloud shifted_tetrahedra(std::size_t layers);

/// The text of an OBJ file.
std::string obj_file(const Cloud& cloud);

}  // namespace trivet::test
