/// Collection of faces with any number of corners while a file is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "storage/common/result.hpp"
#include "storage/data/cloud.hpp"
#include "storage/files/input.hpp"

namespace trivet::formats {

/// Collects faces whose vertices may still be unknown; they are split once all vertices are known.
class Faces {
 public:
  void begin() {
    first_triangle_ = triangles_.size();
    num_corners_ = 0;
  }
  void add(std::uint32_t vertex);
  std::size_t num_corners() const noexcept {
    return num_corners_;
  }  ///< number of corners of the
     ///< current face

  /// Add the triangles of all faces to the cloud's triangles. Faces of fewer than three corners are
  /// dropped.
  /// Pre: every vertex is below cloud.points.size().
  /// Errors: bad_data (concave faces that would take too long to split).
  Result<void> put_into(Cloud& cloud, const Input& input) &&;

 private:
  struct Polygon {
    std::size_t first_triangle = 0, num_triangles = 0;
  };

  Triangles triangles_;            // each face as a triangle fan around its first corner
  std::vector<Polygon> polygons_;  // the faces of more than three corners
  std::size_t first_triangle_ = 0, num_corners_ = 0;
  std::uint32_t first_ = 0, previous_ = 0;
};

}  // namespace trivet::formats
