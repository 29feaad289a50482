/// Meshes that are hardly a surface, or many times the same one.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "storage/data/cloud.hpp"

namespace trivet::test {

struct DegenerateMesh {
  std::string name;  ///< what is wrong with it, and its number of vertices
  Cloud cloud;       ///< its edges all lie between triangles, as of a closed surface
};

/// Of 1 to 12 vertices each: all in one place, in a line, in a plane, in two places, scattered, so
/// small that floats hardly tell them apart, denormal, huge, and far from the origin.
std::vector<DegenerateMesh> degenerate_meshes();

/// A tetrahedron some 200 across whose faces are there `layers` times.
Cloud layered_tetrahedron(std::size_t layers);

/// The same with vertices of its own for each layer, all a little elsewhere.
Cloud shifted_tetrahedra(std::size_t layers);

/// As the text of an OBJ file.
std::string obj_file(const Cloud& cloud);

}  // namespace trivet::test
